#include "slam/places/ground_bev.h"

#include <Eigen/SVD>
#include <opencv2/imgproc.hpp>

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

/// The image relative to the brightness of the ground around, which becomes kFloorGray. Unseen
/// cells are kFloorGray.
cv::Mat WithoutLight(const cv::Mat& image, const cv::Mat& is_seen) {
  cv::Mat values, weights;
  is_seen.convertTo(weights, CV_32F, 1.0 / 255);
  image.convertTo(values, CV_32F);
  const cv::Mat mean = MeanAround(values, weights, kLightSigma);
  cv::Mat flat;
  cv::Mat((values - mean).mul(weights)).convertTo(flat, CV_8U, 1, kFloorGray);
  return cv::max(flat, 1);
}

}  // namespace

GroundBevView::GroundBevView(const RigCamera& camera) {
  const Rigid3 camera_from_body = camera.body_from_camera.Inverse();
  sharpness_ = cv::Mat::zeros(kFloorSize, CV_32FC1);
  for (int row = 0; row < kFloorSize.height; ++row)
    for (int column = 0; column < kFloorSize.width; ++column)
      sharpness_.at<float>(row, column) = static_cast<float>(
          SharpnessAt(camera, camera_from_body, MiddleOfCell(row, column, kFloorCell)));
  map_x_ = cv::Mat(kFloorSize * kFiner, CV_32FC1, cv::Scalar(-1));
  map_y_ = map_x_.clone();
  for (int row = 0; row < map_x_.rows; ++row) {
    for (int column = 0; column < map_x_.cols; ++column) {
      if (sharpness_.at<float>(row / kFiner, column / kFiner) == 0) continue;
      const auto pixel =
          camera.model.Project(camera_from_body * MiddleOfCell(row, column, kFloorCell / kFiner));
      if (!pixel) continue;
      map_x_.at<float>(row, column) = static_cast<float>(pixel->x());
      map_y_.at<float>(row, column) = static_cast<float>(pixel->y());
    }
  }
}

GroundBev GroundBevView::Look(const cv::Mat& image, const Rigid3& keyframe_from_body,
                              int camera) const {
  cv::Mat fine, bev;
  cv::remap(image, fine, map_x_, map_y_, cv::INTER_LINEAR, cv::BORDER_CONSTANT, kUnseen);
  cv::resize(fine, bev, kFloorSize, 0, 0, cv::INTER_AREA);
  const cv::Matx23f move = MoveOfFloor(keyframe_from_body);
  GroundBev observation;
  cv::warpAffine(WithoutLight(bev, sharpness_ > 0), observation.image, move, kFloorSize,
                 cv::INTER_LINEAR, cv::BORDER_CONSTANT, kUnseen);
  cv::warpAffine(sharpness_, observation.sharpness, move, kFloorSize, cv::INTER_NEAREST,
                 cv::BORDER_CONSTANT, kUnseen);
  observation.image.setTo(kUnseen, observation.sharpness == 0);
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
