#pragma once

#include <memory>
#include <vector>

#include "mapping/networks/layer.h"

namespace parkade {

/// A convolution over square windows; its image goes on with zeros beyond its border, so far that
/// the output of stride 1 is as large as it.
struct Convolution {
  int outputs = 0, inputs = 0;  ///< channels
  int side = 1;                 ///< [px] of the window, odd
  int stride = 1;               ///< [px]
  bool is_depthwise = false;    ///< each output is of its own input alone
  bool is_rectified = false;    ///< what is negative becomes 0, before anything is added
  std::vector<float> weights;   ///< outputs x inputs (depthwise: 1) x side x side, as in ONNX
  std::vector<float> bias;      ///< outputs

  float WeightAt(int output, int input, int row, int column) const {
    const int depth = is_depthwise ? 1 : inputs;
    return weights[static_cast<std::size_t>(((output * depth + input) * side + row) * side +
                                            column)];
  }
  cv::Size OutputSize(const cv::Size& input) const {
    return {(input.width - 1) / stride + 1, (input.height - 1) / stride + 1};
  }
};

/// Its bias, with zeros to whole groups.
std::vector<float> PaddedBias(const Convolution& convolution);

/// What computes it in least time: PointwiseLayer, WinogradLayer, WindowLayer, DepthwiseLayer.
std::unique_ptr<Layer> MakeLayer(const Convolution& convolution);

/// One matrix for all pixels: windows of one pixel.
std::unique_ptr<Layer> MakePointwiseLayer(const Convolution& convolution);

/// Rows of windows as one matrix: any dense one.
std::unique_ptr<Layer> MakeWindowLayer(const Convolution& convolution);

/// Dense, 3 x 3, stride 1, with a fourth of the multiplications: F(4 x 4, 3 x 3) of A. Lavin, S.
/// Gray, "Fast algorithms for convolutional neural networks", CVPR 2016. Rounds to about 1e-5 of
/// the sums.
std::unique_ptr<Layer> MakeWinogradLayer(const Convolution& convolution);

/// Depthwise, 3 x 3 or 5 x 5.
std::unique_ptr<Layer> MakeDepthwiseLayer(const Convolution& convolution);

}  // namespace parkade
