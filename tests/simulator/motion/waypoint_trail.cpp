#include "tests/simulator/motion/waypoint_trail.h"

#include <algorithm>

namespace parkade::simulator {

void WaypointTrail::DriveTo(const Eigen::Vector3d& to, double swing, double miss) {
  constexpr double kCornerRoom = 13;  // [m] between waypoints, so that corners fit
  const Eigen::Vector3d from = points_.back();
  const Eigen::Vector2d side = (to - nominal_).head<2>().normalized();
  const Eigen::Vector3d left(-side.y(), side.x(), 0), along(side.x(), side.y(), 0);
  const double length = side.dot((to - from).head<2>());
  const int num_swings = swing > 0 ? std::max(0, static_cast<int>(length / kCornerRoom) - 1) : 0;
  for (int i = 1; i <= num_swings; ++i) {
    const double share = static_cast<double>(i) / (num_swings + 1);
    Eigen::Vector3d point = from + length * share * along + random_.Uniform(-swing, swing) * left;
    point.z() = from.z() + share * (to.z() - from.z());
    points_.push_back(point);
  }
  points_.push_back(to + random_.Uniform(-miss, miss) * (swing > 0 ? along : left));
  nominal_ = to;
}

}  // namespace parkade::simulator
