#include "mapping/markings/rotated_raster.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mapping/markings/ground_tiles.h"

namespace parkade {

RotatedRaster::RotatedRaster(const cv::Mat& brightness, const cv::Mat& mask, double source_size,
                             double direction, double pixel_size)
    : pixel_size_(pixel_size) {
  // Unit vectors of the turned image in the source's pixels (rows south): its rows run along the
  // lines.
  const double scale = pixel_size / source_size;
  const Eigen::Vector2d down = scale * Eigen::Vector2d(std::cos(direction), -std::sin(direction));
  const Eigen::Vector2d right(down.y(), -down.x());
  const double width = brightness.cols, height = brightness.rows;
  const int columns = static_cast<int>(
      (std::abs(right.x()) * width + std::abs(right.y()) * height) / (scale * scale));
  const int rows = static_cast<int>((std::abs(down.x()) * width + std::abs(down.y()) * height) /
                                    (scale * scale));
  const Eigen::Vector2d middle(0.5 * (width - 1), 0.5 * (height - 1));
  source_from_turned_ << right, down,
      middle - 0.5 * (columns - 1) * right - 0.5 * (rows - 1) * down;
  cv::Mat warp(2, 3, CV_64FC1), known;
  for (int i = 0; i < 2; ++i)
    for (int k = 0; k < 3; ++k) warp.at<double>(i, k) = source_from_turned_(i, k);
  const cv::Size size(columns, rows);
  cv::warpAffine(brightness, brightness_, warp, size, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                 cv::BORDER_REPLICATE);
  cv::warpAffine(mask, known, warp, size, cv::INTER_NEAREST | cv::WARP_INVERSE_MAP,
                 cv::BORDER_CONSTANT);
  mask_ = cv::Mat(known.size(), CV_32FC1), sure_ = cv::Mat(known.size(), CV_32FC1);
  for (int row = 0; row < known.rows; ++row)
    for (int column = 0; column < known.cols; ++column) {
      const std::uint8_t value = known.at<std::uint8_t>(row, column);
      mask_.at<float>(row, column) = value == 0 ? 0.0F : 1.0F;
      sure_.at<float>(row, column) = value == GroundTile::kSure ? 1.0F : 0.0F;
    }
}

Eigen::Vector2d RotatedRaster::SourceOf(double column, double row) const {
  return source_from_turned_ * Eigen::Vector3d(column, row, 1);
}

}  // namespace parkade
