#include "tests/bench/loops/wrong_loops.h"

#include <cmath>
#include <random>

#include "slam/loops/keyframe_graph.h"
#include "slam/pose_graph/robust_pose_graph.h"

namespace parkade {
namespace {

/// Numbers from 0 to 1, the same with every library.
class Dice {
 public:
  explicit Dice(std::uint32_t seed) : random_(seed) {}
  double Throw() { return (static_cast<double>(random_()) + 0.5) / 4294967296.0; }
  double Within(double limit) { return limit * (2 * Throw() - 1); }
  size_t Index(size_t size) {
    return std::min(size - 1, static_cast<size_t>(Throw() * static_cast<double>(size)));
  }

 private:
  std::mt19937 random_;
};

PoseGraphEdge EdgeOf(const LoopEvidence& loop, size_t first) {
  return {first + loop.earlier_keyframe, first + loop.later_keyframe, loop.pose.a_from_b,
          loop.share * loop.pose.information, false};
}

}  // namespace

MixedLoops MixInWrongLoops(const Trajectory& odometry, const LoopClosure& closure,
                           const LoopOptions& options, const WrongLoopOptions& wrong) {
  MixedLoops mixed;
  mixed.odom_from_body = odometry;
  const std::vector<RigKeyframe> keyframes = ChooseKeyframes(odometry, options.keyframes);
  std::vector<Rigid3> poses;
  for (const RigKeyframe& keyframe : keyframes) poses.push_back(keyframe.odom_from_keyframe);
  PoseGraph graph = WorldGraph();
  const size_t first = AddKeyframes(keyframes, poses, options, 0, graph);
  graph.vertices[first].is_fixed = true;
  const size_t num_trusted = graph.edges.size();
  for (const LoopEvidence& loop : closure.loops)
    if (loop.weight > 0.5) graph.edges.push_back(EdgeOf(loop, first));
  mixed.num_right = graph.edges.size() - num_trusted;
  const auto group = static_cast<size_t>(std::max(wrong.group, 1));
  if (mixed.num_right == 0 || keyframes.size() <= group) return mixed;

  Dice dice(wrong.seed);
  mixed.num_wrong = static_cast<size_t>(
      std::lround(wrong.share / (1 - wrong.share) * static_cast<double>(mixed.num_right)));
  for (size_t i = 0; i < mixed.num_wrong;) {
    const size_t last = keyframes.size() - group;
    const auto [earlier, later] = std::minmax({dice.Index(last + 1), dice.Index(last + 1)});
    if (keyframes[later].distance - keyframes[earlier].distance < options.recognition.min_gap)
      continue;
    const double base = options.recognition.drift_base, height = options.recognition.height_base;
    const Rigid3 seeming{
        ExpSo3({0, 0, dice.Within(M_PI)}),
        Eigen::Vector3d(dice.Within(base), dice.Within(base), dice.Within(height))};
    for (size_t k = 0; k < group && i < mixed.num_wrong; ++k, ++i) {
      PoseGraphEdge edge = graph.edges[num_trusted + dice.Index(mixed.num_right)];
      edge.from = first + earlier + k;
      edge.to = first + later + k;
      edge.from_from_to = poses[earlier + k].Inverse() * poses[earlier] * seeming *
                          poses[later].Inverse() * poses[later + k];
      graph.edges.push_back(edge);
    }
  }
  RobustPoseGraphOptions robust;
  robust.graph.objective = "information";
  robust.adapts_noise = false;
  const RobustPoseGraphSummary summary = OptimizePoseGraphRobustly(robust, graph);
  for (size_t i = num_trusted; i < graph.edges.size(); ++i) {
    const bool is_right = i<num_trusted + mixed.num_right, is_kept = summary.weights[i]> 0.5;
    mixed.num_right_lost += is_right && !is_kept;
    mixed.num_wrong_kept += !is_right && is_kept;
  }
  for (size_t i = 0; i < poses.size(); ++i) poses[i] = graph.vertices[first + i].world_from_vertex;
  mixed.odom_from_body = CarryAlong(odometry, keyframes, poses);
  return mixed;
}

}  // namespace parkade
