#include "mapping/markings/rotated_raster.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <opencv2/imgproc.hpp>

#include "mapping/markings/ground_tiles.h"

namespace parkade {
namespace {

/// The box around the turned places of all pixels that are not 0, in turned pixels; empty where
/// there are none.
Eigen::AlignedBox2d BoxOfSeen(const cv::Mat1b& mask,
                              const Eigen::Matrix<double, 2, 3>& turned_from_source) {
  Eigen::AlignedBox2d box;
  for (int row = 0; row < mask.rows; ++row) {
    const std::uint8_t* begin = mask[row];
    const std::uint8_t* end = begin + mask.cols;
    const auto is_seen = [](std::uint8_t value) { return value != 0; };
    const std::uint8_t* first = std::find_if(begin, end, is_seen);
    if (first == end) continue;
    const auto last =
        std::find_if(std::reverse_iterator(end), std::reverse_iterator(first), is_seen);
    for (const auto column : {first - begin, last.base() - 1 - begin})
      box.extend(turned_from_source * Eigen::Vector3d(static_cast<double>(column), row, 1));
  }
  return box;
}

}  // namespace

RotatedRaster::RotatedRaster(const cv::Mat& brightness, const cv::Mat& mask, double source_size,
                             double direction, double pixel_size, double margin)
    : pixel_size_(pixel_size) {
  // Unit vectors of the turned image in the source's pixels (rows south): its rows run along the
  // lines.
  const double scale = pixel_size / source_size;
  const Eigen::Vector2d down = scale * Eigen::Vector2d(std::cos(direction), -std::sin(direction));
  const Eigen::Vector2d right(down.y(), -down.x());
  const Eigen::Vector2d middle(0.5 * (brightness.cols - 1), 0.5 * (brightness.rows - 1));
  Eigen::Matrix2d turn;
  turn << right, down;
  Eigen::Matrix<double, 2, 3> turned_from_source;
  turned_from_source << turn.inverse(), -turn.inverse() * middle;
  const Eigen::AlignedBox2d seen = BoxOfSeen(mask, turned_from_source);
  Eigen::Vector2d corner = Eigen::Vector2d::Zero();
  cv::Size size(1, 1);
  if (!seen.isEmpty()) {
    const Eigen::Vector2d reach = Eigen::Vector2d::Constant(margin / pixel_size + 1);
    corner = (seen.min() - reach).array().floor();
    const Eigen::Vector2i extent = (seen.max() + reach - corner).array().ceil().cast<int>();
    size = {extent.x() + 1, extent.y() + 1};
  }
  source_from_turned_ << turn, middle + turn * corner;
  cv::Mat warp(2, 3, CV_64FC1), known;
  for (int i = 0; i < 2; ++i)
    for (int k = 0; k < 3; ++k) warp.at<double>(i, k) = source_from_turned_(i, k);
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
