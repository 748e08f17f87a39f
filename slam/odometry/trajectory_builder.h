#pragma once

#include <optional>
#include <vector>

#include "core/rig.h"
#include "core/trajectory.h"
#include "slam/factors/sample_buffer.h"
#include "slam/odometry/early_records.h"
#include "slam/smoother/drive_measurements.h"

namespace parkade {

/// Turns finished nodes into the states of a trajectory: body instead of IMU,
/// and as many states between nodes as asked for, shaped by the IMU and bent
/// linearly so that they meet the nodes.
class TrajectoryBuilder {
 public:
  TrajectoryBuilder(const Rig& rig, double output_interval);

  /// Sets where the IMU sits for the states that follow, once the cameras are calibrated.
  void MountOn(const Rig& rig) { imu_from_body_ = rig.body_from_imu.Inverse(); }

  /// Adds a node; they come in order of time. `interval`: since the node before, empty at the
  /// first.
  void Add(const RecordedNode& node, const std::optional<NodeInterval>& interval);

  /// Adds states of the time before the first node, running backwards on the gyroscope and the
  /// wheels, or on the IMU alone where there are none. `is_still`: the car stood all that time.
  std::vector<TrajectoryState> StatesBefore(const EarlyRecords& early, bool is_still) const;

  bool empty() const { return states_.empty(); }
  /// All states, in order of time.
  std::vector<TrajectoryState> Take();

 private:
  TrajectoryState ToBody(const MotionState& state, const Eigen::Vector3d& angular_velocity,
                         const Eigen::Matrix<double, 6, 6>& covariance) const;
  void AddBetween(const MotionState& first, const RecordedNode& second,
                  const NodeInterval& interval);

  Rigid3 imu_from_body_;
  double output_interval_;
  std::optional<MotionState> first_, last_;
  std::vector<TrajectoryState> states_;
};

}  // namespace parkade
