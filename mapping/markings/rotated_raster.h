#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace parkade {

/// An image of the ground turned so that lines of one direction stand upright, as far as something
/// was seen.
class RotatedRaster {
 public:
  static constexpr float kDark = 15;  ///< of 255: contrast to what is darker is noise

  /// \param brightness   CV_32FC1, rows south, columns east
  /// \param mask         CV_8UC1 of the same size, as GroundTile::mask
  /// \param source_size  [m] of its pixels
  /// \param direction    [rad] of the lines, counter-clockwise from east
  /// \param pixel_size   [m] of the turned image's pixels
  /// \param margin       [m] to keep around what was seen: as far as filters reach
  RotatedRaster(const cv::Mat& brightness, const cv::Mat& mask, double source_size,
                double direction, double pixel_size, double margin);

  /// The pixel of the source at (column, row) of the turned image.
  Eigen::Vector2d SourceOf(double column, double row) const;

  const cv::Mat& brightness() const { return brightness_; }  ///< CV_32FC1
  const cv::Mat& mask() const { return mask_; }  ///< CV_32FC1: 1 where something was seen, else 0
  const cv::Mat& sure() const { return sure_; }  ///< CV_32FC1: 1 where that is ground, else 0
  double pixel_size() const { return pixel_size_; }  ///< [m]

 private:
  double pixel_size_;
  Eigen::Matrix<double, 2, 3> source_from_turned_;
  cv::Mat brightness_, mask_, sure_;
};

}  // namespace parkade
