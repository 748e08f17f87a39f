#include "mapping/networks/convolution.h"

#include <algorithm>

#include "mapping/networks/matrix_product.h"
#include "mapping/networks/vectors.h"

namespace parkade {
namespace {

class PointwiseLayer : public Layer {
 public:
  explicit PointwiseLayer(const Convolution& convolution)
      : outputs_(convolution.outputs),
        is_rectified_(convolution.is_rectified),
        matrix_(convolution.inputs, convolution.outputs,
                [&](int input, int output) { return convolution.WeightAt(output, input, 0, 0); }),
        bias_(PaddedBias(convolution)) {}

  int OutputChannels(int) const override { return outputs_; }
  bool TakesAnyStep() const override { return true; }

  void Run(const LayerImage& input, const float* added, const LayerImage& output,
           FloatBuffer&) const override {
    Multiply({input.data, input.step, input.num_pixels()}, matrix_,
             {bias_.data(), is_rectified_, added}, output.data);
  }

 private:
  int outputs_;
  bool is_rectified_;
  PackedMatrix matrix_;
  std::vector<float> bias_;
};

class WindowLayer : public Layer {
 public:
  explicit WindowLayer(const Convolution& convolution)
      : convolution_(convolution),
        matrix_(convolution.side * convolution.side * convolution.inputs, convolution.outputs,
                [&](int at, int output) {
                  const int pixel = at / convolution.inputs;
                  return convolution.WeightAt(output, at % convolution.inputs,
                                              pixel / convolution.side, pixel % convolution.side);
                }),
        bias_(PaddedBias(convolution)) {}

  cv::Size OutputSize(const cv::Size& input) const override {
    return convolution_.OutputSize(input);
  }
  int OutputChannels(int) const override { return convolution_.outputs; }
  bool TakesAnyStep() const override { return true; }

  void Run(const LayerImage& input, const float* added, const LayerImage& output,
           FloatBuffer& scratch) const override {
    const auto side = static_cast<std::size_t>(convolution_.side);
    const auto step = static_cast<std::size_t>(convolution_.inputs);
    const auto length = (static_cast<std::size_t>(input.size.width) + side - 1) * step;
    MatrixRows windows{.data = scratch.AtLeast(side * length),
                       .step = static_cast<std::size_t>(convolution_.stride) * step,
                       .count = static_cast<std::size_t>(output.size.width),
                       .num_parts = side,
                       .part_step = length};
    for (int row = 0; row < output.size.height; ++row) {
      CopyRows(input, row * convolution_.stride - convolution_.side / 2, length,
               scratch.AtLeast(side * length));
      const float* added_row =
          added == nullptr ? nullptr : added + (output.At(row, 0) - output.data);
      Multiply(windows, matrix_, {bias_.data(), convolution_.is_rectified, added_row},
               output.At(row, 0));
    }
  }

 private:
  /// Rows of the image from `top` on, as many as a window's, with zeros where they are off it.
  void CopyRows(const LayerImage& input, int top, std::size_t length, float* to) const {
    const auto channels = static_cast<std::size_t>(convolution_.inputs);
    const std::size_t margin = static_cast<std::size_t>(convolution_.side / 2) * channels;
    for (int row = top; row < top + convolution_.side; ++row, to += length) {
      std::fill_n(to, length, 0.0F);
      if (row < 0 || row >= input.size.height) continue;
      const std::size_t num_pixels = static_cast<std::size_t>(input.size.width);
      if (input.step == channels)
        std::copy_n(input.At(row, 0), num_pixels * channels, to + margin);
      else
        for (std::size_t pixel = 0; pixel < num_pixels; ++pixel)
          std::copy_n(input.At(row, 0) + pixel * input.step, channels,
                      to + margin + pixel * channels);
    }
  }

  Convolution convolution_;
  PackedMatrix matrix_;
  std::vector<float> bias_;
};

}  // namespace

std::vector<float> PaddedBias(const Convolution& convolution) {
  std::vector<float> bias = convolution.bias;
  bias.resize(RoundUpToGroup(bias.size()), 0);
  return bias;
}

std::unique_ptr<Layer> MakePointwiseLayer(const Convolution& convolution) {
  return std::make_unique<PointwiseLayer>(convolution);
}

std::unique_ptr<Layer> MakeWindowLayer(const Convolution& convolution) {
  return std::make_unique<WindowLayer>(convolution);
}

std::unique_ptr<Layer> MakeLayer(const Convolution& convolution) {
  if (convolution.is_depthwise) return MakeDepthwiseLayer(convolution);
  if (convolution.stride != 1) return MakeWindowLayer(convolution);
  switch (convolution.side) {
    case 1: return MakePointwiseLayer(convolution);
    case 3: return MakeWinogradLayer(convolution);
    default: return MakeWindowLayer(convolution);
  }
}

}  // namespace parkade
