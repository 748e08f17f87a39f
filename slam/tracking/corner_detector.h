#pragma once

#include <Eigen/Core>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace parkade {

/// Finds corners spread evenly over an image: at most one per empty grid cell
/// first, more per cell only while the budget lasts. What counts as a corner is
/// relative to its own cell, so that dim parts of an image get some too.
class CornerDetector {
 public:
  /// \param usable  CV_8UC1 of the image's size; sets the cell size so that its
  ///     area holds `max_corners` cells
  CornerDetector(const cv::Mat& usable, int max_corners);

  /// New corners [px], best first within each round, none closer than
  /// min_distance() to `present` or to each other; at most max_corners -
  /// present.size(). Integer pixels: the patch around one is what is tracked.
  ///
  /// \param pyramid    as in TrackedImage
  /// \param is_wanted  asked for each corner that would be added
  std::vector<Eigen::Vector2d> Detect(
      const std::vector<cv::Mat>& pyramid, const cv::Mat& usable,
      const std::vector<Eigen::Vector2d>& present,
      const std::function<bool(const Eigen::Vector2d& pixel)>& is_wanted) const;

  int cell_size() const { return cell_size_; }              ///< [px]
  double min_distance() const { return 0.6 * cell_size_; }  ///< [px]

 private:
  int max_corners_ = 0;
  int cell_size_ = 1;  ///< [px]
};

}  // namespace parkade
