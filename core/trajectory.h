#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/rigid3.h"
#include "core/timestamp.h"

namespace parkade {

/// The car's state at one instant.
struct TrajectoryState {
  Timestamp time;
  Rigid3 world_from_body;  ///< the trajectory says which world: odom or site
  Eigen::Vector3d velocity_in_world = Eigen::Vector3d::Zero();  ///< [m/s] of the body origin
  Eigen::Vector3d gyroscope_bias = Eigen::Vector3d::Zero();
  Eigen::Vector3d accelerometer_bias = Eigen::Vector3d::Zero();
  /// Covariance of [rotation vector in body (rad), translation in world (m)].
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

/// Timed poses of one drive in a world frame, strictly increasing in time. The variable's name says
/// which world it is: `odom_from_body`, gravity-aligned (z up) and drifting, or `site_from_body`.
/// Copies share what they hold.
class Trajectory {
 public:
  Trajectory() = default;
  /// Throws Error{kInternal} unless times strictly increase and all is finite.
  explicit Trajectory(std::vector<TrajectoryState> states);

  const std::vector<TrajectoryState>& states() const;
  bool empty() const { return states().empty(); }
  TimeSpan span() const;
  double Length() const;  ///< [m] traveled by the body origin

  /// Geodesic interpolation inside the span, nothing outside. O(log n).
  std::optional<Rigid3> At(Timestamp time) const;

  /// The same drive in another world frame: `target_from_world` applied to poses
  /// and velocities.
  Trajectory Transformed(const Rigid3& target_from_world) const;

 private:
  std::shared_ptr<const std::vector<TrajectoryState>> states_;  ///< null: none
};

/// One pose of a TUM file.
struct TimedPose {
  Timestamp time;
  Rigid3 world_from_frame;
};

/// `t x y z qx qy qz qw` per line, '#' comments and blank lines skipped.
/// Throws Error{kInvalidInput} naming file and line.
std::vector<TimedPose> ReadTum(const std::filesystem::path& file);

/// Times with 9 digits, meters and quaternions with 9. Whole or not at all.
void WriteTum(const std::vector<TimedPose>& poses, const std::filesystem::path& file);

}  // namespace parkade
