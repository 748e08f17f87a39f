#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/camera_model.h"
#include "core/rigid3.h"

namespace parkade {

/// The inside of a box with random, band-limited texture, seen through any lens:
/// images whose every pixel has a known point. Frame `room`: z up, floor at 0.
class RenderedRoom {
 public:
  RenderedRoom(const Eigen::Vector3d& low, const Eigen::Vector3d& high, std::uint32_t seed);

  /// [m] along a unit `direction` from inside the room to its wall.
  double RangeAlong(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;

  /// Gray level in [0, 255] of a point on a wall; details below `footprint` [m] are left out.
  double BrightnessAt(const Eigen::Vector3d& point_in_room, double footprint) const;

 private:
  Eigen::Vector3d low_, high_;
  std::uint32_t seed_ = 0;
};

/// Draws a room for one camera; remembers the bearing of every pixel.
class RoomCamera {
 public:
  RoomCamera(const CameraModel& model, const RenderedRoom& room);

  /// CV_8UC1; pixels without a bearing are black. `noise` [gray levels] is added
  /// with a fixed seed per `frame`.
  cv::Mat Render(const Rigid3& room_from_camera, double noise = 1.0, int frame = 0) const;

  /// Where the point that `pixel` shows from one place is seen from another;
  /// false where it is not.
  bool Follow(const Eigen::Vector2d& pixel, const Rigid3& room_from_first,
              const Rigid3& room_from_second, Eigen::Vector2d* second) const;

  const CameraModel& model() const { return model_; }

 private:
  CameraModel model_;
  const RenderedRoom& room_;
  std::vector<Eigen::Vector3d> bearings_;  ///< per pixel; zero where there is none
};

/// A fisheye of about 190 degrees as it sits on cars, 640 x 400.
CameraModel SurroundFisheye();

}  // namespace parkade
