#include "slam/places/ground_bev.h"

#include <Eigen/SVD>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/off_image.h"
#include "core/yaw.h"
#include "slam/places/weighted_blur.h"

namespace parkade {
namespace {

constexpr int kFiner = 2;            // samples per cell and direction
constexpr double kMinSharpness = 6;  // [px/m]; with less, details of 10 cm do not show
constexpr double kMaxFlatness =
    4.5;  // distance over height; beyond, pillars and walls hide the ground more and more
constexpr double kLightSigma = 6;  // cells: changes over more than this are light
constexpr double kBorder = 3;      // [px] of the image that are not trusted
const cv::Scalar kUnseen = cv::Scalar(0);

Eigen::Vector3d MiddleOfCell(double row, double column, double cell) {
  return {kFloorFront - (row + 0.5) * cell, kFloorLeft - (column + 0.5) * cell, 0};
}

/// [px/m] of a point on the ground in the direction in which the image resolves it worst; 0 where
/// it is not seen.
double SharpnessAt(const RigCamera& camera, const Rigid3& camera_from_body,
                   const Eigen::Vector3d& point) {
  const Eigen::Vector3d observation = point - camera.body_from_camera.translation;
  if (observation.head<2>().norm() > -kMaxFlatness * observation.z()) return 0;
  CameraModel::Jacobian jacobian;
  const auto pixel = camera.model.Project(camera_from_body * point, &jacobian);
  if (!pixel || !camera.IsUsable(*pixel, kBorder)) return 0;
  const Eigen::Matrix2d on_ground =
      jacobian * camera_from_body.rotation.toRotationMatrix().leftCols<2>();
  const double worst = on_ground.jacobiSvd().singularValues()(1);
  return worst < kMinSharpness ? 0 : worst;
}

/// The smallest box around what is seen, and a rim of one for interpolation.
cv::Rect BoxOf(const cv::Mat& is_seen) {
  const cv::Rect seen = cv::boundingRect(is_seen);
  if (seen.empty()) return {};
  return cv::Rect(seen.x - 1, seen.y - 1, seen.width + 2, seen.height + 2) &
         cv::Rect({}, is_seen.size());
}

/// The map from a part of a floor that begins at `from` to a part of the moved one, at `to`.
cv::Matx23f BetweenParts(cv::Matx23f move, const cv::Point& from, const cv::Point& to) {
  const auto x = static_cast<float>(from.x), y = static_cast<float>(from.y);
  move(0, 2) += move(0, 0) * x + move(0, 1) * y - static_cast<float>(to.x);
  move(1, 2) += move(1, 0) * x + move(1, 1) * y - static_cast<float>(to.y);
  return move;
}

/// Where a part of a floor comes to lie.
cv::Rect Moved(const cv::Rect& part, const cv::Matx23f& move) {
  std::vector<cv::Point2f> corners;
  for (const int x : {part.x, part.x + part.width})
    for (const int y : {part.y, part.y + part.height}) {
      const cv::Vec2f corner = move * cv::Vec3f(static_cast<float>(x), static_cast<float>(y), 1);
      corners.emplace_back(corner[0], corner[1]);
    }
  return cv::boundingRect(corners) & cv::Rect({}, kFloorSize);
}

}  // namespace

GroundBevView::GroundBevView(const RigCamera& camera) {
  const Rigid3 camera_from_body = camera.body_from_camera.Inverse();
  cv::Mat sharpness = cv::Mat::zeros(kFloorSize, CV_32FC1);
  for (int row = 0; row < kFloorSize.height; ++row)
    for (int column = 0; column < kFloorSize.width; ++column)
      sharpness.at<float>(row, column) = static_cast<float>(
          SharpnessAt(camera, camera_from_body, MiddleOfCell(row, column, kFloorCell)));
  box_ = BoxOf(sharpness > 0);
  if (box_.empty()) return;
  sharpness_ = sharpness(box_).clone();
  cv::Mat(sharpness_ > 0).convertTo(weights_, CV_32F, 1.0 / 255);
  weights_around_ = WeightsAround(weights_, kLightSigma);
  cv::Mat map_x(box_.size() * kFiner, CV_32FC1, cv::Scalar(kOffImage)), map_y = map_x.clone();
  for (int row = 0; row < map_x.rows; ++row) {
    for (int column = 0; column < map_x.cols; ++column) {
      if (sharpness_.at<float>(row / kFiner, column / kFiner) == 0) continue;
      const auto pixel = camera.model.Project(
          camera_from_body *
          MiddleOfCell(kFiner * box_.y + row, kFiner * box_.x + column, kFloorCell / kFiner));
      if (!pixel) continue;
      map_x.at<float>(row, column) = static_cast<float>(pixel->x());
      map_y.at<float>(row, column) = static_cast<float>(pixel->y());
    }
  }
  cv::convertMaps(map_x, map_y, places_, fractions_, CV_16SC2);
}

cv::Mat GroundBevView::WithoutLight(const cv::Mat& image) const {
  cv::Mat values, flat;
  image.convertTo(values, CV_32F);
  const cv::Mat mean = MeanAround(values, weights_, weights_around_, kLightSigma);
  cv::Mat((values - mean).mul(weights_)).convertTo(flat, CV_8U, 1, kFloorGray);
  return cv::max(flat, 1);
}

GroundBev GroundBevView::Look(const cv::Mat& image, const Rigid3& keyframe_from_body,
                              int camera) const {
  GroundBev observation;
  observation.image = cv::Mat(kFloorSize, CV_8UC1, kUnseen);
  observation.sharpness = cv::Mat(kFloorSize, CV_32FC1, kUnseen);
  const cv::Matx23f move = MoveOfFloor(keyframe_from_body);
  if (const cv::Rect to = Moved(box_, move); !box_.empty() && !to.empty()) {
    cv::Mat fine, bev;
    cv::remap(image, fine, places_, fractions_, cv::INTER_LINEAR, cv::BORDER_CONSTANT, kUnseen);
    cv::resize(fine, bev, box_.size(), 0, 0, cv::INTER_AREA);
    const cv::Matx23f between = BetweenParts(move, box_.tl(), to.tl());
    cv::Mat moved = observation.image(to), sharpness = observation.sharpness(to);
    cv::warpAffine(WithoutLight(bev), moved, between, to.size(), cv::INTER_LINEAR,
                   cv::BORDER_CONSTANT, kUnseen);
    cv::warpAffine(sharpness_, sharpness, between, to.size(), cv::INTER_NEAREST,
                   cv::BORDER_CONSTANT, kUnseen);
    moved.setTo(kUnseen, sharpness == 0);
  }
  observation.camera = cv::Mat(kFloorSize, CV_8UC1, cv::Scalar(camera));
  return observation;
}

cv::Matx23f MoveOfFloor(const Rigid3& to_from) {
  const double yaw = YawOf(to_from.rotation), c = std::cos(yaw), s = std::sin(yaw);
  // Position in the frame of the pixel (u, v); u counts to the right and v to the back, y and x
  // against them.
  const double u0 = kFloorLeft / kFloorCell - 0.5, v0 = kFloorFront / kFloorCell - 0.5;
  const double tx = to_from.translation.x() / kFloorCell, ty = to_from.translation.y() / kFloorCell;
  return {
      static_cast<float>(c),  static_cast<float>(s), static_cast<float>(u0 - s * v0 - c * u0 - ty),
      static_cast<float>(-s), static_cast<float>(c), static_cast<float>(v0 - c * v0 + s * u0 - tx)};
}

void AddObservation(const GroundBev& observation, GroundBev& floor) {
  if (floor.image.empty()) {
    floor = {observation.image.clone(), observation.sharpness.clone(), observation.camera.clone()};
    return;
  }
  const cv::Mat is_sharper = observation.sharpness > floor.sharpness;
  observation.image.copyTo(floor.image, is_sharper);
  observation.sharpness.copyTo(floor.sharpness, is_sharper);
  observation.camera.copyTo(floor.camera, is_sharper);
}

cv::Mat ImageOf(const GroundBev& floor) {
  if (floor.image.empty()) return {};
  cv::Mat lowest, highest, image = floor.image.clone();
  cv::erode(floor.camera, lowest, {});
  cv::dilate(floor.camera, highest, {});
  image.setTo(kUnseen, lowest != highest);
  return image;
}

}  // namespace parkade
