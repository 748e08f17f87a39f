#include "slam/loops/keyframe_graph.h"

#include <algorithm>

#include "slam/loops/loop_closure.h"
#include "slam/odometry/odometry_drift.h"

namespace parkade {
namespace {

constexpr std::int64_t kWorldId = -1'000'000;

double Square(double x) { return x * x; }

/// The odometry's own figure, kept within a factor of `by_options`.
double Drift(double by_odometry, double by_options) {
  constexpr double kLeast = 0.3, kMost = 2;
  return by_odometry > 0 ? std::clamp(by_odometry, kLeast * by_options, kMost * by_options)
                         : by_options;
}

}  // namespace

LoopOptions WithDriftOf(const Trajectory& odometry, LoopOptions options) {
  const OdometryDrift drift = DriftOf(odometry);
  options.odometry_translation = Drift(drift.translation, options.odometry_translation);
  options.odometry_yaw = Drift(drift.yaw, options.odometry_yaw);
  return options;
}

PoseGraph WorldGraph() {
  PoseGraph graph;
  graph.vertices.push_back({kWorldId, {}, true});
  return graph;
}

size_t AddKeyframes(const std::vector<RigKeyframe>& keyframes,
                    const std::vector<Rigid3>& world_from_keyframe, const LoopOptions& options,
                    std::int64_t first_id, PoseGraph& graph) {
  const size_t first = graph.vertices.size();
  for (size_t i = 0; i < keyframes.size(); ++i) {
    graph.vertices.push_back(
        {first_id + static_cast<std::int64_t>(i), world_from_keyframe[i], false});
    if (i > 0) {
      const double way = std::max(keyframes[i].distance - keyframes[i - 1].distance, 0.1);
      Vector6d variances;
      variances << Eigen::Vector3d::Constant(Square(options.odometry_translation) * way),
          Eigen::Vector3d(Square(options.odometry_tilt), Square(options.odometry_tilt),
                          Square(options.odometry_yaw) * way);
      graph.edges.push_back(
          {first + i - 1, first + i,
           keyframes[i - 1].odom_from_keyframe.Inverse() * keyframes[i].odom_from_keyframe,
           variances.cwiseInverse().asDiagonal(), true});
    }
    // Gravity: keyframes are level, whatever their yaw and position.
    PoseGraphEdge gravity{0, first + i, world_from_keyframe[i], Matrix6d::Zero(), true};
    gravity.information(3, 3) = gravity.information(4, 4) = 1 / Square(options.odometry_tilt);
    graph.edges.push_back(gravity);
  }
  return first;
}

}  // namespace parkade
