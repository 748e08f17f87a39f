#include "slam/places/floor_view.h"

#include <Eigen/SVD>
#include <opencv2/imgproc.hpp>

#include "core/yaw.h"
#include "slam/places/weighted_blur.h"

namespace parkade {
namespace {

constexpr int kFiner = 2;             // samples per cell and direction
constexpr double kMinSharpness = 6;   // [px/m]; less shows nothing of 10 cm
constexpr double kMaxFlatness = 4.5;  // distance over height; beyond, pillars and walls hide the ground more and more
constexpr double kLightSigma = 6;     // cells: changes over more than this are light
constexpr double kBorder = 3;         // [px] of the image that are not trusted
const cv::Scalar kUnseen = cv::Scalar(0);

Eigen::Vector3d MiddleOfCell(double row, double column, double cell) {
  return {kFloorFront - (row + 0.5) * cell, kFloorLeft - (column + 0.5) * cell, 0};
}

/// [px/m] of a point on the ground in the direction in which the image resolves it worst; 0 where it is not seen.
double SharpnessAt(const RigCamera& camera, const Rigid3& camera_from_body, const Eigen::Vector3d& point) {
  const Eigen::Vector3d sight = point - camera.body_from_camera.translation;
  if (sight.head<2>().norm() > -kMaxFlatness * sight.z()) return 0;
  CameraModel::Jacobian jacobian;
  const auto pixel = camera.model.Project(camera_from_body * point, &jacobian);
  if (!pixel || !camera.IsUsable(*pixel, kBorder)) return 0;
  const Eigen::Matrix2d on_ground = jacobian * camera_from_body.rotation.toRotationMatrix().leftCols<2>();
  const double worst = on_ground.jacobiSvd().singularValues()(1);
  return worst < kMinSharpness ? 0 : worst;
}

/// What is brighter or darker than the ground around, about kFloorGrey. Unseen cells are kFloorGrey.
cv::Mat WithoutLight(const cv::Mat& picture, const cv::Mat& is_seen) {
  cv::Mat values, weights;
  is_seen.convertTo(weights, CV_32F, 1.0 / 255);
  picture.convertTo(values, CV_32F);
  const cv::Mat mean = MeanAround(values, weights, kLightSigma);
  cv::Mat flat;
  cv::Mat((values - mean).mul(weights)).convertTo(flat, CV_8U, 1, kFloorGrey);
  return cv::max(flat, 1);
}

}  // namespace

FloorView::FloorView(const RigCamera& camera) {
  const Rigid3 camera_from_body = camera.body_from_camera.Inverse();
  sharpness_ = cv::Mat::zeros(kFloorSize, CV_32FC1);
  for (int row = 0; row < kFloorSize.height; ++row)
    for (int column = 0; column < kFloorSize.width; ++column)
      sharpness_.at<float>(row, column) =
          static_cast<float>(SharpnessAt(camera, camera_from_body, MiddleOfCell(row, column, kFloorCell)));
  map_x_ = cv::Mat(kFloorSize * kFiner, CV_32FC1, cv::Scalar(-1));
  map_y_ = map_x_.clone();
  for (int row = 0; row < map_x_.rows; ++row) {
    for (int column = 0; column < map_x_.cols; ++column) {
      if (sharpness_.at<float>(row / kFiner, column / kFiner) == 0) continue;
      const auto pixel = camera.model.Project(camera_from_body * MiddleOfCell(row, column, kFloorCell / kFiner));
      if (!pixel) continue;
      map_x_.at<float>(row, column) = static_cast<float>(pixel->x());
      map_y_.at<float>(row, column) = static_cast<float>(pixel->y());
    }
  }
}

FloorSight FloorView::Look(const cv::Mat& image, const Rigid3& place_from_body, int camera) const {
  cv::Mat fine, picture;
  cv::remap(image, fine, map_x_, map_y_, cv::INTER_LINEAR, cv::BORDER_CONSTANT, kUnseen);
  cv::resize(fine, picture, kFloorSize, 0, 0, cv::INTER_AREA);
  const cv::Matx23f move = MoveOfFloor(place_from_body);
  FloorSight sight;
  cv::warpAffine(WithoutLight(picture, sharpness_ > 0), sight.picture, move, kFloorSize, cv::INTER_LINEAR,
                 cv::BORDER_CONSTANT, kUnseen);
  cv::warpAffine(sharpness_, sight.sharpness, move, kFloorSize, cv::INTER_NEAREST, cv::BORDER_CONSTANT, kUnseen);
  sight.picture.setTo(kUnseen, sight.sharpness == 0);
  sight.camera = cv::Mat(kFloorSize, CV_8UC1, cv::Scalar(camera));
  return sight;
}

cv::Matx23f MoveOfFloor(const Rigid3& to_from) {
  const double yaw = YawOf(to_from.rotation), c = std::cos(yaw), s = std::sin(yaw);
  // Of the pixel (u, v) in the middle of the frame; u counts to the right and v to the back, y and x against them.
  const double u0 = kFloorLeft / kFloorCell - 0.5, v0 = kFloorFront / kFloorCell - 0.5;
  const double tx = to_from.translation.x() / kFloorCell, ty = to_from.translation.y() / kFloorCell;
  return {static_cast<float>(c),  static_cast<float>(s), static_cast<float>(u0 - s * v0 - c * u0 - ty),
          static_cast<float>(-s), static_cast<float>(c), static_cast<float>(v0 - c * v0 + s * u0 - tx)};
}

void AddSight(const FloorSight& sight, FloorSight& floor) {
  if (floor.picture.empty()) {
    floor = {sight.picture.clone(), sight.sharpness.clone(), sight.camera.clone()};
    return;
  }
  const cv::Mat is_sharper = sight.sharpness > floor.sharpness;
  sight.picture.copyTo(floor.picture, is_sharper);
  sight.sharpness.copyTo(floor.sharpness, is_sharper);
  sight.camera.copyTo(floor.camera, is_sharper);
}

cv::Mat PictureOf(const FloorSight& floor) {
  if (floor.picture.empty()) return {};
  cv::Mat lowest, highest, picture = floor.picture.clone();
  cv::erode(floor.camera, lowest, {});
  cv::dilate(floor.camera, highest, {});
  picture.setTo(kUnseen, lowest != highest);
  return picture;
}

}  // namespace parkade
