#pragma once

#include <optional>
#include <vector>

#include "slam/places/relative_pose.h"
#include "slam/places/rig_keyframe.h"

namespace parkade {

inline constexpr int kCamerasPerKeyframe = 64;  // more than any rig has

/// A ray of one keyframe to a point of the other. `is_forward`: the ray is of `a`, the point of
/// `b`.
struct RayPointCorrespondence {
  bool is_forward = true;
  size_t match = 0;
  int camera_pair = 0;              ///< kCamerasPerKeyframe * camera of `a` + camera of `b`
  Eigen::Vector3d origin, bearing;  ///< of the ray, in its keyframe
  Eigen::Vector3d point;            ///< in the other keyframe
  Eigen::Vector3d point_origin;     ///< from where the point was seen, in the other keyframe
  double ray_sigma = 0;             ///< [rad]
  double point_sigma = 0;           ///< [m] across the line of sight from point_origin
  double depth_sigma = 0;           ///< [m] along it
};

/// The correspondences of all matches: up to two for each.
std::vector<RayPointCorrespondence> CorrespondencesOf(const RigKeyframe& a, const RigKeyframe& b,
                                                      const std::vector<FeatureMatch>& matches);

/// Angle between ray and point in units of its sigma, which holds the point's error as seen from
/// the ray's origin.
struct CorrespondenceError {
  Eigen::Vector2d whitened;              ///< across the ray
  Eigen::Matrix<double, 2, 6> jacobian;  ///< by [translation | turn] on the right of a_from_b
  bool is_in_front = false;
};
CorrespondenceError ErrorOf(const RayPointCorrespondence& correspondence, const Rigid3& a_from_b);

/// Whether the point lies before the camera and less than `max_error` sigmas off the ray: ErrorOf
/// without derivatives.
bool IsInlier(const RayPointCorrespondence& correspondence, const Rigid3& a_from_b,
              double max_error);

/// Derivatives of CorrespondenceError::whitened by errors of the mounts of the two cameras,
/// [translation | turn] in the body. Where one camera saw both, they add up.
struct MountJacobians {
  int ray_camera = 0, point_camera = 0;
  Eigen::Matrix<double, 2, 6> by_ray, by_point;
};
MountJacobians MountJacobiansOf(const RayPointCorrespondence& correspondence,
                                const Rigid3& a_from_b);

/// Poses with yaw alone that two correspondences of the same direction allow, at most two.
std::vector<Rigid3> SolveUprightPose(const RayPointCorrespondence& first,
                                     const RayPointCorrespondence& second);

}  // namespace parkade
