#include "mapping/networks/level_view.h"

#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "core/off_image.h"

namespace parkade {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kAzimuthStep = 0.23 * kDegree;  // [rad] per column
// Elevation of a row: kPivot - kSpread sinh((row + 0.5 - kPivotRow) kFinest / kSpread).
constexpr double kPivot = -6 * kDegree, kSpread = 12 * kDegree, kFinest = 0.142 * kDegree,
                 kPivotRow = 93;
constexpr double kFarGround = -3 * kDegree,
                 kNearGround = -20 * kDegree;  // elevations of the ground that views are for
constexpr double kMinSeenShare = 0.5;

double AzimuthOf(double column) { return (column + 0.5 - 0.5 * LevelView::kWidth) * kAzimuthStep; }

double ElevationOf(double row) {
  return kPivot - kSpread * std::sinh((row + 0.5 - kPivotRow) * kFinest / kSpread);
}

/// The lens of images that are no more than twice as fine as the view: what is finer would be
/// skipped, not averaged.
CameraModel Reduced(const CameraModel& model) {
  const Eigen::Vector2d middle(0.5 * model.width(), 0.5 * model.height());
  const double fineness = model.PixelsPerRadian(middle).value_or(0) * kAzimuthStep;
  return fineness < 2 ? model : model.Scaled(1 / std::floor(fineness));
}

/// The optical axis's azimuth.
double HeadingOf(const Rigid3& ground_from_camera) {
  const Eigen::Vector3d axis = ground_from_camera.rotation * Eigen::Vector3d::UnitZ();
  return std::atan2(axis.y(), axis.x());
}

}  // namespace

std::optional<LevelView> LevelView::Of(const CameraModel& full_model,
                                       const Rigid3& ground_from_camera) {
  const CameraModel model = Reduced(full_model);
  LevelView view;
  view.image_ = {model.width(), model.height()};
  view.heading_ = HeadingOf(ground_from_camera);
  const Eigen::Matrix3d camera_from_ground =
      ground_from_camera.rotation.conjugate().toRotationMatrix();
  cv::Mat columns(kHeight, kWidth, CV_32FC1, cv::Scalar(kOffImage)), rows = columns.clone();
  int num_ground = 0, num_seen = 0;
  for (int row = 0; row < kHeight; ++row) {
    const double elevation = ElevationOf(row);
    const bool is_ground = elevation < kFarGround && elevation > kNearGround;
    for (int column = 0; column < kWidth; ++column) {
      const double toward = view.heading_ - AzimuthOf(column);
      const Eigen::Vector3d ray(std::cos(elevation) * std::cos(toward),
                                std::cos(elevation) * std::sin(toward), std::sin(elevation));
      num_ground += is_ground;
      const std::optional<Eigen::Vector2d> pixel = model.Project(camera_from_ground * ray);
      if (!pixel || !model.IsInImage(*pixel, -1)) continue;
      num_seen += is_ground;
      columns.at<float>(row, column) = static_cast<float>(pixel->x());
      rows.at<float>(row, column) = static_cast<float>(pixel->y());
    }
  }
  if (num_seen < kMinSeenShare * num_ground) return std::nullopt;
  cv::convertMaps(columns, rows, view.places_, view.fractions_, CV_16SC2);
  return view;
}

cv::Mat LevelView::Show(const cv::Mat& image) const {
  cv::Mat reduced = image, shown;
  if (image.size() != image_) cv::resize(image, reduced, image_, 0, 0, cv::INTER_AREA);
  cv::remap(reduced, shown, places_, fractions_, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  return shown;
}

Eigen::Vector2f LevelView::PixelOf(const Eigen::Vector3d& direction_in_ground) const {
  const double to_right =
      std::remainder(heading_ - std::atan2(direction_in_ground.y(), direction_in_ground.x()),
                     2 * std::numbers::pi);
  const double elevation =
      std::atan2(direction_in_ground.z(), direction_in_ground.head<2>().norm());
  const double column = to_right / kAzimuthStep + 0.5 * kWidth - 0.5;
  const double row =
      std::asinh((kPivot - elevation) / kSpread) * kSpread / kFinest + kPivotRow - 0.5;
  return Eigen::Vector2d(column, row).cast<float>();
}

}  // namespace parkade
