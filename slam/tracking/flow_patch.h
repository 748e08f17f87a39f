#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "slam/tracking/flow_kernels.h"

namespace parkade {

/// A square patch of an image with what is needed to follow it into others: inverse compositional
/// Gauss-Newton over translation (S. Baker, I. Matthews, "Lucas-Kanade 20 years on", IJCV 2004).
/// Samples are integers: all processors find the same.
///
/// Images are levels of BuildPyramid, which go on beyond their edges.
class FlowPatch {
 public:
  static constexpr int kMaxEdge = flow::kMaxStride - 2;  ///< [px]

  explicit FlowPatch(int edge);  ///< [px] odd, up to kMaxEdge

  /// Takes the patch around `center` [px]. False where that is outside, or where the patch does not
  /// fix both coordinates.
  bool Take(const cv::Mat& image, const cv::Point2f& center);

  /// The way [px] from `center` to where the patch is in `image`, in first order; nothing where
  /// `center` is outside.
  std::optional<cv::Point2f> StepFrom(const cv::Mat& image, const cv::Point2f& center) const;

  /// False where nothing of the patch would be in the image.
  bool IsInside(const cv::Mat& image, const cv::Point2f& center) const;

 private:
  int Stride() const { return edge_ + 2; }  ///< of the samples, which have a margin

  int edge_ = 0;
  cv::Matx22f inverse_;                                ///< [px^2 / (gray levels)^2]
  alignas(32) flow::Samples is_inside_{};              ///< -1 in the columns of the patch
  alignas(32) flow::Samples samples_{};                ///< with a margin of 1 px
  alignas(32) flow::Samples slopes_x_{}, slopes_y_{};  ///< 0 outside the patch
};

}  // namespace parkade
