#pragma once

#include <Eigen/Core>
#include <vector>

#include "tests/simulator/common/random.h"

namespace parkade::simulator {

/// Waypoints of a driver who swings a little from side to side, as drivers do.
class WaypointTrail {
 public:
  WaypointTrail(const Eigen::Vector3d& start, std::uint64_t seed)
      : random_(seed, 0xd21e), nominal_(start), points_{start} {}

  /// Drives from where it is to `to`, up to `swing` [m] beside the straight line on the way,
  /// and misses the end by up to `miss` [m] along and across.
  void DriveTo(const Eigen::Vector3d& to, double swing, double miss);

  const Eigen::Vector3d& nominal() const { return nominal_; }  ///< where the last leg was to end
  std::vector<Eigen::Vector3d> Take() { return std::move(points_); }

 private:
  Random random_;
  Eigen::Vector3d nominal_;
  std::vector<Eigen::Vector3d> points_;
};

}  // namespace parkade::simulator
