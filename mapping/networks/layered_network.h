#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "mapping/networks/layer_plan.h"

namespace parkade {

/// A convolutional network made of what Parkade's own are made of: convolutions (dense or
/// depthwise, windows of odd sides, stride 1 or 2) with Relu and Add behind them, enlargement by 2
/// and functions of single numbers. Takes a third of the time that OpenCV 4.6 does.
///
/// Immutable, thread-safe: what a call writes is in its buffers.
class LayeredNetwork {
 public:
  /// Memory of one call at a time, to be used again: as much as the largest images needed.
  struct Buffers {
    std::vector<FloatBuffer> images;
    FloatBuffer scratch;
  };

  /// Nothing where the file is no ONNX, or where something in it is unknown here.
  static std::optional<LayeredNetwork> Read(std::string_view model);

  /// \param input  1 x C x H x W, CV_32F. Returns 1 x c x h x w. Throws Error{kInvalidInput} for
  ///               other channels, and for sizes that the network does not come out even with.
  cv::Mat Run(const cv::Mat& input, Buffers& buffers) const;

 private:
  explicit LayeredNetwork(LayerPlan plan) : plan_(std::move(plan)) {}

  LayerPlan plan_;
};

}  // namespace parkade
