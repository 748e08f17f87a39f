#include "mapping/networks/convolution.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>

#include "mapping/networks/vectors.h"
#include "tests/mapping/worlds/layer_run.h"

namespace parkade {
namespace {

constexpr double kRounding = 2e-5;          // of sums of some hundred products of numbers below 1
constexpr double kWinogradRounding = 2e-4;  // its transforms have factors of up to 100

struct Shape {
  int inputs, outputs, side, stride;
};

Convolution MakeConvolution(const Shape& shape, bool is_depthwise, bool is_rectified) {
  Convolution convolution{.outputs = shape.outputs,
                          .inputs = shape.inputs,
                          .side = shape.side,
                          .stride = shape.stride,
                          .is_depthwise = is_depthwise,
                          .is_rectified = is_rectified,
                          .weights = {},
                          .bias = {}};
  const int depth = is_depthwise ? 1 : shape.inputs;
  convolution.weights = RandomFloats(shape.outputs * depth * shape.side * shape.side, 1);
  convolution.bias = RandomFloats(shape.outputs, 2);
  return convolution;
}

/// By its definition, of one channel of one pixel.
double Expected(const Convolution& convolution, const LayerImage& input, const cv::Point& place,
                int output) {
  double sum = static_cast<double>(convolution.bias[static_cast<size_t>(output)]);
  for (int i = 0; i < convolution.side; ++i)
    for (int j = 0; j < convolution.side; ++j) {
      const cv::Point at(place.x * convolution.stride + j - convolution.side / 2,
                         place.y * convolution.stride + i - convolution.side / 2);
      if (!cv::Rect({}, input.size).contains(at)) continue;
      for (int channel = 0; channel < convolution.inputs; ++channel)
        if (!convolution.is_depthwise || channel == output)
          sum += static_cast<double>(input.At(at.y, at.x)[channel]) *
                 static_cast<double>(
                     convolution.WeightAt(output, convolution.is_depthwise ? 0 : channel, i, j));
    }
  return convolution.is_rectified ? std::max(sum, 0.0) : sum;
}

/// The largest difference between a layer and the definition; what lies behind the channels counts.
double LargestError(const Layer& layer, const Convolution& convolution, const cv::Size& size,
                    bool is_something_added) {
  const LayerRun run(layer, size, convolution.inputs, is_something_added);
  double largest = 0;
  for (int row = 0; row < run.output.size.height; ++row)
    for (int column = 0; column < run.output.size.width; ++column)
      for (int channel = 0; channel < static_cast<int>(run.output.step); ++channel) {
        const double expected = channel < convolution.outputs
                                    ? Expected(convolution, run.input, {column, row}, channel) +
                                          run.AddedAt(row, column, channel)
                                    : 0;
        const double found = static_cast<double>(run.output.At(row, column)[channel]);
        largest = std::max(largest, std::abs(found - expected));
      }
  return largest;
}

/// Over sizes with and without rest.
double LargestError(const Layer& layer, const Convolution& convolution) {
  double largest = 0;
  for (const cv::Size& size : {cv::Size(1, 1), cv::Size(2, 5), cv::Size(8, 4), cv::Size(13, 9)})
    for (const bool is_something_added : {false, true})
      largest = std::max(largest, LargestError(layer, convolution, size, is_something_added));
  return largest;
}

TEST(PointwiseLayer, IsAMatrixForEveryPixel) {
  for (const int outputs : {1, 9, 16, 24, 40}) {
    const Convolution convolution = MakeConvolution({12, outputs, 1, 1}, false, outputs == 9);
    EXPECT_LT(LargestError(*MakePointwiseLayer(convolution), convolution), kRounding) << outputs;
  }
}

TEST(WindowLayer, TakesWindowsOfAnySizeAndStride) {
  for (const Shape& shape : {Shape{3, 12, 3, 2}, Shape{12, 24, 3, 2}, Shape{8, 8, 5, 1}}) {
    const Convolution convolution = MakeConvolution(shape, false, shape.inputs == 12);
    EXPECT_LT(LargestError(*MakeWindowLayer(convolution), convolution), kRounding) << shape.inputs;
  }
}

TEST(WinogradLayer, IsTheDenseConvolutionOf3x3) {
  for (const Shape& shape : {Shape{15, 12, 3, 1}, Shape{24, 24, 3, 1}, Shape{48, 40, 3, 1}}) {
    const Convolution convolution = MakeConvolution(shape, false, shape.inputs == 24);
    EXPECT_LT(LargestError(*MakeWinogradLayer(convolution), convolution), kWinogradRounding)
        << shape.inputs;
  }
}

TEST(WinogradLayer, TakesLargeImagesInParts) {
  const Convolution convolution = MakeConvolution({8, 8, 3, 1}, false, true);

  EXPECT_LT(LargestError(*MakeWinogradLayer(convolution), convolution, {401, 29}, true),
            kWinogradRounding);
}

TEST(DepthwiseLayer, TakesEachChannelAlone) {
  for (const int side : {3, 5})
    for (const int stride : {1, 2}) {
      const Convolution convolution = MakeConvolution({12, 12, side, stride}, true, stride == 2);
      EXPECT_LT(LargestError(*MakeDepthwiseLayer(convolution), convolution), kRounding)
          << side << " " << stride;
    }
}

TEST(Convolution, OfEveryKindTheLayerMadeIsTheSame) {
  for (const Shape& shape : {Shape{8, 8, 1, 1}, Shape{8, 8, 1, 2}, Shape{8, 8, 3, 1},
                             Shape{8, 8, 3, 2}, Shape{8, 8, 5, 1}})
    for (const bool is_depthwise : {false, true}) {
      if (is_depthwise && shape.side == 1) continue;
      const Convolution convolution = MakeConvolution(shape, is_depthwise, true);
      EXPECT_LT(LargestError(*MakeLayer(convolution), convolution), kWinogradRounding)
          << shape.side << " " << shape.stride;
    }
}

}  // namespace
}  // namespace parkade
