#include "tests/slam/worlds/rendered_room.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

namespace parkade {
namespace {

double Hash(std::int64_t x, std::int64_t y, std::uint32_t seed) {
  auto h = static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15u ^
           static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4Fu;
  h ^= static_cast<std::uint64_t>(seed) * 0x165667B19E3779F9u;
  h = (h ^ (h >> 29)) * 0xBF58476D1CE4E5B9u;
  return static_cast<double>((h ^ (h >> 32)) & 0xFFFFFF) / 0xFFFFFF;
}

/// Smooth noise in [0, 1] with features about 1 wide.
double Noise(double x, double y, std::uint32_t seed) {
  const double fx = std::floor(x), fy = std::floor(y);
  const auto ix = static_cast<std::int64_t>(fx), iy = static_cast<std::int64_t>(fy);
  const auto smooth = [](double t) { return t * t * t * (t * (6 * t - 15) + 10); };
  const double u = smooth(x - fx), v = smooth(y - fy);
  const double top = std::lerp(Hash(ix, iy, seed), Hash(ix + 1, iy, seed), u);
  const double bottom = std::lerp(Hash(ix, iy + 1, seed), Hash(ix + 1, iy + 1, seed), u);
  return std::lerp(top, bottom, v);
}

}  // namespace

RenderedRoom::RenderedRoom(const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                           std::uint32_t seed)
    : low_(low), high_(high), seed_(seed) {}

double RenderedRoom::RangeAlong(const Eigen::Vector3d& origin,
                                const Eigen::Vector3d& direction) const {
  double range = 1e300;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0) continue;
    const double wall = direction[axis] > 0 ? high_[axis] : low_[axis];
    range = std::min(range, (wall - origin[axis]) / direction[axis]);
  }
  return range;
}

double RenderedRoom::BrightnessAt(const Eigen::Vector3d& point, double footprint) const {
  int face = 0;
  double nearest = 1e300;
  for (int axis = 0; axis < 3; ++axis) {
    for (const auto& [distance, index] : {std::pair(point[axis] - low_[axis], 2 * axis),
                                          std::pair(high_[axis] - point[axis], 2 * axis + 1)}) {
      if (distance >= nearest) continue;
      nearest = distance;
      face = index;
    }
  }
  const int normal = face / 2;
  const double x = point[(normal + 1) % 3], y = point[(normal + 2) % 3];
  double brightness = 128;
  double width = 0.6;  // [m]
  for (std::uint32_t octave = 0; octave < 4; ++octave, width *= 0.5) {
    const double visible = std::clamp(width / footprint / 2 - 1, 0.0, 1.0);
    if (visible == 0) break;
    const std::uint32_t seed = seed_ + 31 * static_cast<std::uint32_t>(face) + 7 * octave;
    brightness += visible * 80 * (Noise(x / width, y / width, seed) - 0.5);
  }
  return std::clamp(brightness, 0.0, 255.0);
}

RoomCamera::RoomCamera(const CameraModel& model, const RenderedRoom& room)
    : model_(model), room_(room) {
  bearings_.reserve(static_cast<size_t>(model.width() * model.height()));
  for (int y = 0; y < model.height(); ++y)
    for (int x = 0; x < model.width(); ++x)
      bearings_.push_back(model.Unproject({x, y}).value_or(Eigen::Vector3d::Zero()));
}

cv::Mat RoomCamera::Render(const Rigid3& room_from_camera, double noise, int frame) const {
  cv::Mat image = cv::Mat::zeros(model_.height(), model_.width(), CV_8UC1);
  cv::RNG random(static_cast<std::uint64_t>(frame) + 1);
  const double pixels_per_radian =
      model_.PixelsPerRadian({0.5 * model_.width(), 0.5 * model_.height()}).value();
  const Eigen::Matrix3d rotation = room_from_camera.rotation.toRotationMatrix();
  size_t index = 0;
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x, ++index) {
      if (bearings_[index].isZero()) continue;
      const Eigen::Vector3d direction = rotation * bearings_[index];
      const double range = room_.RangeAlong(room_from_camera.translation, direction);
      const Eigen::Vector3d point = room_from_camera.translation + range * direction;
      const double brightness =
          room_.BrightnessAt(point, range / pixels_per_radian) + random.gaussian(noise);
      image.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(brightness);
    }
  }
  return image;
}

bool RoomCamera::Follow(const Eigen::Vector2d& pixel, const Rigid3& room_from_first,
                        const Rigid3& room_from_second, Eigen::Vector2d* second) const {
  const auto bearing = model_.Unproject(pixel);
  if (!bearing) return false;
  const Eigen::Vector3d direction = room_from_first.rotation * *bearing;
  const Eigen::Vector3d point =
      room_from_first.translation +
      room_.RangeAlong(room_from_first.translation, direction) * direction;
  const auto seen = model_.Project(room_from_second.Inverse() * point);
  if (seen) *second = *seen;
  return seen.has_value();
}

CameraModel SurroundFisheye() {
  return {KannalaBrandtProjection{
              .fx = 193, .fy = 193, .cx = 319.5, .cy = 199.5, .k1 = -0.01, .k2 = 0.002},
          640, 400};
}

}  // namespace parkade
