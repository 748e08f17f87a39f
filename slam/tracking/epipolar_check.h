#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace parkade {

/// One track in two images of the same camera.
struct BearingPair {
  Eigen::Vector3d last, now;     ///< unit, each in its camera frame
  double radians_per_pixel = 0;  ///< at `now`
};

/// How well pairs agree with one rigid motion of the camera.
struct EpipolarCheck {
  std::vector<bool> agrees;                                     ///< one per pair
  Eigen::Matrix3d now_from_last = Eigen::Matrix3d::Identity();  ///< the predicted rotation, refined
  /// Unit, in `now`: where points at the last camera center have moved to
  /// (minus the direction of travel). Arbitrary when nothing shows parallax.
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
  bool is_trusted = false;  ///< false: too few pairs or too little agreement; then all agree
};

/// Finds the pairs that no camera motion near the predicted rotation explains:
/// moving things and mismatches. Two-point RANSAC for the direction of
/// translation with the rotation known, then rotation (5 unknowns together)
/// refined by reweighted least squares.
///
/// Pure rotation and standstill need no special case: without parallax every
/// direction explains every pair. Distances are off the epipolar plane, and
/// pairs that move from instead of toward `direction` are refused too.
///
/// D. Scaramuzza, F. Fraundorfer, "Visual odometry", RAM 2011; L. Kneip et al.,
/// "Robust real-time visual odometry with a single camera and an IMU", BMVC 2011
/// (two-point RANSAC with known rotation). Deterministic.
EpipolarCheck CheckEpipolarGeometry(const std::vector<BearingPair>& pairs,
                                    const Eigen::Matrix3d& now_from_last, double max_error_px);

/// Whether one more pair agrees with a trusted check.
bool Agrees(const EpipolarCheck& check, const BearingPair& pair, double max_error_px);

}  // namespace parkade
