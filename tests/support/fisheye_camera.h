#pragma once

#include <cmath>
#include <string>

#include "core/rig.h"

namespace parkade {

/// A camera of a rig for tests, `width` x `height` px, that looks along `yaw` [rad] to the left of
/// forward, `down` [rad] below the horizon. Its lens has no distortion but the equidistant one.
inline RigCamera MakeFisheyeCamera(const std::string& name, const Eigen::Vector3d& position,
                                   double yaw, double down, double focal_length, int width,
                                   int height) {
  Eigen::Matrix3d body_from_camera;
  body_from_camera.col(2) << std::cos(yaw) * std::cos(down), std::sin(yaw) * std::cos(down),
      -std::sin(down);
  body_from_camera.col(0) << std::sin(yaw), -std::cos(yaw), 0;
  body_from_camera.col(1) = body_from_camera.col(2).cross(body_from_camera.col(0));
  RigCamera camera;
  camera.name = name;
  camera.topic = "/" + name;
  camera.body_from_camera = {Eigen::Quaterniond(body_from_camera), position};
  camera.model = CameraModel(KannalaBrandtProjection{.fx = focal_length,
                                                     .fy = focal_length,
                                                     .cx = (width - 1) / 2.0,
                                                     .cy = (height - 1) / 2.0},
                             width, height);
  return camera;
}

}  // namespace parkade
