#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <span>
#include <vector>

#include "core/rig.h"
#include "core/trajectory.h"
#include "mapping/ground/wheelbase_footprint.h"

namespace parkade {

/// How a body leans on its springs, per acceleration: the plane on which it seems to stand is not
/// the road.
struct SuspensionModel {
  double roll = 0;   ///< [rad/(m/s^2)] lifts the left side when accelerating to the left
  double pitch = 0;  ///< [rad/(m/s^2)] lifts the front when accelerating
  double heave = 0;  ///< [m/(m/s^2)] lifts the rear axle when accelerating

  /// [m] by which the body's plane lies above the road at a point of frame `ground`, per roll,
  /// pitch and heave. `acceleration` is that of AccelerationAt.
  static Eigen::Vector3d LiftPerLean(const Eigen::Vector2d& acceleration,
                                     const Eigen::Vector2d& point_in_ground) {
    return {acceleration.y() * point_in_ground.y(), acceleration.x() * point_in_ground.x(),
            acceleration.x()};
  }
  double LiftAt(const Eigen::Vector2d& acceleration, const Eigen::Vector2d& point_in_ground) const {
    return LiftPerLean(acceleration, point_in_ground).dot(Eigen::Vector3d(roll, pitch, heave));
  }
};

/// One drive through the site, as the ground needs it: where its wheels stood and where its cameras
/// were.
struct DrivenPath {
  int drive = 0;              ///< as GroundPatch::drive
  Trajectory site_from_body;  ///< final
  Rigid3 body_from_ground;    ///< of GroundObservation
  WheelbaseFootprint contact;
  std::vector<Eigen::Vector3d>
      cameras_in_body;        ///< [m] optical centers, indexed as GroundPatch::camera
  SuspensionModel lean = {};  ///< none until it is estimated
  double plane_errors = 1;    ///< of SuspensionFit
};

/// The path of a drive among `paths`; null where there is none.
inline const DrivenPath* FindPath(std::span<const DrivenPath> paths, int drive) {
  const auto found = std::find_if(paths.begin(), paths.end(),
                                  [&](const DrivenPath& p) { return p.drive == drive; });
  return found == paths.end() ? nullptr : &*found;
}

DrivenPath MakeDrivenPath(int drive, const Rig& rig, const Trajectory& site_from_body,
                          const Rigid3& body_from_ground);

/// Acceleration [m/s^2] of the body at `time` toward its front and its left, from its path alone; 0
/// near the ends.
Eigen::Vector2d AccelerationAt(const Trajectory& site_from_body, Timestamp time);

/// A point of the road under an axle or, without a known car, under the body.
struct ContactPoint {
  Eigen::Vector3d point_in_site;
  bool is_front = false;  ///< of the front axle: the suspension's pitch acts there
};

/// Contacts about every `spacing` [m] of travel; one set at standstill. The path's lean is taken
/// out.
std::vector<ContactPoint> FindContacts(const DrivenPath& path, double spacing);

}  // namespace parkade
