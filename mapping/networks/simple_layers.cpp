#include "mapping/networks/simple_layers.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "mapping/networks/doubled_row.h"

namespace parkade {
namespace {

class DoublingLayer : public Layer {
 public:
  cv::Size OutputSize(const cv::Size& input) const override { return input * 2; }

  void Run(const LayerImage& input, const float* added, const LayerImage& output,
           FloatBuffer&) const override {
    for (int row = 0; row < output.size.height; ++row) {
      const int near = row / 2, far = row % 2 == 0 ? near - 1 : near + 1;
      float* to = output.At(row, 0);
      FillDoubledRow({.near = input.At(near, 0),
                      .far = input.At(std::clamp(far, 0, input.size.height - 1), 0),
                      .width = static_cast<std::size_t>(input.size.width),
                      .step = input.step,
                      .added = added == nullptr ? nullptr : added + (to - output.data),
                      .output = to});
    }
  }
};

/// A function of every float alone, which keeps zero.
template <typename Function>
class ElementLayer : public Layer {
 public:
  explicit ElementLayer(Function function) : function_(function) {}

  void Run(const LayerImage& input, const float* added, const LayerImage& output,
           FloatBuffer&) const override {
    assert(added == nullptr);
    static_cast<void>(added);
    const std::size_t step = input.step, channels = static_cast<std::size_t>(input.channels);
    for (std::size_t pixel = 0; pixel < input.num_pixels(); ++pixel)
      for (std::size_t at = pixel * step; at < pixel * step + channels; ++at)
        output.data[at] = function_(input.data[at]);
  }

 private:
  Function function_;
};

}  // namespace

std::unique_ptr<Layer> MakeDoublingLayer() { return std::make_unique<DoublingLayer>(); }

std::unique_ptr<Layer> MakeScaleLayer(float factor) {
  const auto scale = [factor](float value) { return factor * value; };
  return std::make_unique<ElementLayer<decltype(scale)>>(scale);
}

std::unique_ptr<Layer> MakeTanhLayer() {
  const auto tanh = [](float value) { return std::tanh(value); };
  return std::make_unique<ElementLayer<decltype(tanh)>>(tanh);
}

}  // namespace parkade
