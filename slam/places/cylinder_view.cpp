#include "slam/places/cylinder_view.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/off_image.h"

namespace parkade {
namespace {

constexpr double kHalfWidth = 1.3;  // [rad] to each side of the optical axis
constexpr double kLowest = -1.3;    // tangent of the elevation
constexpr double kHighest = 0.8;    // tangent of the elevation
constexpr double kBorder = 3;       // [px] of the image that are not trusted
constexpr int kMargin = 48;         // [px] around what is usable, so that detectors go on up to it

/// What is usable, with a margin; all where nothing is.
cv::Rect WindowOf(const cv::Mat1b& usable) {
  const cv::Rect all({}, usable.size()), box = cv::boundingRect(usable);
  if (box.empty()) return all;
  return (box - cv::Point(kMargin, kMargin) + cv::Size(2 * kMargin, 2 * kMargin)) & all;
}

}  // namespace

CylinderView::CylinderView(const RigCamera& camera, const Eigen::Quaterniond& upright_from_body) {
  const Eigen::Quaterniond upright_from_camera =
      upright_from_body * camera.body_from_camera.rotation;
  const Eigen::Vector3d axis = upright_from_camera * Eigen::Vector3d::UnitZ();
  const Eigen::Vector2d middle(0.5 * camera.model.width(), 0.5 * camera.model.height());
  scale_ = camera.model.PixelsPerRadian(middle).value_or(0.3 * camera.model.width());
  azimuth_ = std::atan2(axis.y(), axis.x()) + kHalfWidth;
  highest_ = kHighest;
  const int width = static_cast<int>(2 * kHalfWidth * scale_),
            height = static_cast<int>((kHighest - kLowest) * scale_);
  cv::Mat1f map_x(height, width, kOffImage), map_y(height, width, kOffImage);
  cv::Mat1b usable(height, width, std::uint8_t{0});
  const Eigen::Quaterniond camera_from_upright = upright_from_camera.conjugate();
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const auto pixel = camera.model.Project(camera_from_upright * BearingInUpright(column, row));
      if (!pixel || !camera.IsUsable(*pixel, kBorder)) continue;
      map_x(row, column) = static_cast<float>(pixel->x());
      map_y(row, column) = static_cast<float>(pixel->y());
      usable(row, column) = 255;
    }
  }
  const cv::Rect window = WindowOf(usable);
  map_x_ = map_x(window).clone();
  map_y_ = map_y(window).clone();
  usable_ = usable(window).clone();
  azimuth_ -= window.x / scale_;
  highest_ -= window.y / scale_;
}

cv::Mat CylinderView::Warp(const cv::Mat& image) const {
  cv::Mat view;
  cv::remap(image, view, map_x_, map_y_, cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar(0));
  return view;
}

Eigen::Vector3d CylinderView::BearingInUpright(double column, double row) const {
  const double azimuth = azimuth_ - column / scale_;
  return Eigen::Vector3d(std::cos(azimuth), std::sin(azimuth), highest_ - row / scale_)
      .normalized();
}

Eigen::Vector2f CylinderView::ImagePoint(double column, double row) const {
  const int x = static_cast<int>(std::lround(column)), y = static_cast<int>(std::lround(row));
  return {map_x_.at<float>(y, x), map_y_.at<float>(y, x)};
}

}  // namespace parkade
