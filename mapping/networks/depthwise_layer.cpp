#include <algorithm>
#include <cassert>

#include "mapping/networks/convolution.h"
#include "mapping/networks/depthwise_rows.h"
#include "mapping/networks/vectors.h"

namespace parkade {
namespace {

class DepthwiseLayer : public Layer {
 public:
  explicit DepthwiseLayer(const Convolution& convolution)
      : convolution_(convolution), bias_(PaddedBias(convolution)) {
    const std::size_t step = bias_.size();
    const int side = convolution.side;
    weights_.resize(static_cast<std::size_t>(side * side) * step);
    for (int k = 0; k < side * side; ++k)
      for (int channel = 0; channel < convolution.outputs; ++channel)
        weights_[static_cast<std::size_t>(k) * step + static_cast<std::size_t>(channel)] =
            convolution.WeightAt(channel, 0, k / side, k % side);
  }

  cv::Size OutputSize(const cv::Size& input) const override {
    return convolution_.OutputSize(input);
  }

  void Run(const LayerImage& input, const float* added, const LayerImage& output,
           FloatBuffer&) const override {
    DepthwiseRow row{.input = input,
                     .weights = weights_.data(),
                     .stride = convolution_.stride,
                     .width = output.size.width,
                     .finish = {bias_.data(), convolution_.is_rectified, nullptr}};
    for (int k = 0; k < output.size.height; ++k) {
      row.output = output.At(k, 0);
      row.top = k * convolution_.stride - convolution_.side / 2;
      if (added != nullptr) row.finish.added = added + (row.output - output.data);
      if (convolution_.side == 3)
        ConvolveDepthwise3(row);
      else
        ConvolveDepthwise5(row);
    }
  }

 private:
  Convolution convolution_;
  std::vector<float> bias_;
  std::vector<float> weights_;  // side x side x channels
};

}  // namespace

std::unique_ptr<Layer> MakeDepthwiseLayer(const Convolution& convolution) {
  assert(convolution.side == 3 || convolution.side == 5);
  return std::make_unique<DepthwiseLayer>(convolution);
}

}  // namespace parkade
