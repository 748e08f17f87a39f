#include "slam/loops/close_loops.h"

#include <algorithm>
#include <chrono>

#include "slam/loops/keyframe_graph.h"
#include "slam/loops/loop_shares.h"
#include "slam/loops/measure_loops.h"
#include "slam/loops/reviewed_loops.h"
#include "slam/pose_graph/robust_pose_graph.h"

namespace parkade {
namespace {

/// Vertex 0 is the world, vertex i + 1 is keyframe i.
PoseGraph GraphOf(const std::vector<RigKeyframe>& keyframes, const LoopOptions& options) {
  PoseGraph graph = WorldGraph();
  std::vector<Rigid3> poses;
  poses.reserve(keyframes.size());
  for (const RigKeyframe& keyframe : keyframes) poses.push_back(keyframe.odom_from_keyframe);
  graph.vertices[AddKeyframes(keyframes, poses, options, 0, graph)].is_fixed = true;
  return graph;
}

/// The loop's edge, the last of the graph. Where it is between cameras that are not the keyframes
/// themselves, they become vertices, tied to their keyframes.
void AddLoop(const PlaceCandidate& candidate, const LoopEvidence& loop, const LoopOptions& options,
             PoseGraph& graph) {
  const Matrix6d information = loop.share * loop.pose.information;
  const bool is_between_keyframes = options.method == "rig" || options.method == "pnp";
  if (is_between_keyframes) {
    graph.edges.push_back({candidate.earlier + 1, candidate.later + 1, loop.pose.a_from_b,
                           information, loop.is_forced});
    return;
  }
  constexpr double kRigid = 1e8;  // [1/m^2], [1/rad^2]
  const size_t first = graph.vertices.size();
  const auto add_camera = [&](size_t keyframe, const Rigid3& keyframe_from_camera) {
    // Their ids lie far from all others: nothing but their keyframe is near them in time.
    const auto id = static_cast<std::int64_t>(1'000'000'000 + 100 * graph.vertices.size());
    graph.vertices.push_back(
        {id, graph.vertices[keyframe].world_from_vertex * keyframe_from_camera, false});
    graph.edges.push_back({keyframe, graph.vertices.size() - 1, keyframe_from_camera,
                           kRigid * Matrix6d::Identity(), true});
  };
  add_camera(candidate.earlier + 1, loop.earlier_from_camera);
  add_camera(candidate.later + 1, loop.later_from_camera);
  const Rigid3 camera_from_camera =
      loop.earlier_from_camera.Inverse() * loop.pose.a_from_b * loop.later_from_camera;
  graph.edges.push_back({first, first + 1, camera_from_camera, information, loop.is_forced});
}

/// Poses of the keyframes once loops are closed; sets the loops' weights.
std::vector<Rigid3> Optimize(const std::vector<RigKeyframe>& keyframes,
                             const std::vector<PlaceCandidate>& candidates,
                             const LoopOptions& options, LoopClosure& closure) {
  PoseGraph graph = GraphOf(keyframes, options);
  std::vector<std::optional<size_t>> edge_of_loop(candidates.size());
  int num_loops = 0;
  for (size_t i = 0; i < candidates.size(); ++i) {
    const RelativePose& pose = closure.loops[i].pose;
    if (!pose.rejected.empty()) continue;
    AddLoop(candidates[i], closure.loops[i], options, graph);
    edge_of_loop[i] = graph.edges.size() - 1;
    ++num_loops;
  }
  std::vector<Rigid3> poses;
  if (num_loops > 0) {
    RobustPoseGraphOptions robust;
    robust.graph.objective = "information";
    robust.adapts_noise = false;
    const RobustPoseGraphSummary summary = OptimizePoseGraphRobustly(robust, graph);
    for (size_t i = 0; i < candidates.size(); ++i) {
      if (edge_of_loop[i]) {
        closure.loops[i].weight = summary.weights[*edge_of_loop[i]];
        closure.loops[i].chi_squared = summary.chi_squared[*edge_of_loop[i]];
      }
      closure.num_accepted += closure.loops[i].weight > 0.5;
    }
  }
  for (size_t i = 0; i < keyframes.size(); ++i)
    poses.push_back(graph.vertices[i + 1].world_from_vertex);
  return poses;
}

}  // namespace

Trajectory CarryAlong(const Trajectory& odometry, const std::vector<RigKeyframe>& keyframes,
                      const std::vector<Rigid3>& odom_from_corrected) {
  std::vector<TrajectoryState> states = odometry.states();
  size_t before = 0;
  for (TrajectoryState& state : states) {
    while (before + 1 < keyframes.size() && keyframes[before + 1].time <= state.time) ++before;
    const size_t after = std::min(before + 1, keyframes.size() - 1);
    const auto moved_with = [&](size_t keyframe) {
      return odom_from_corrected[keyframe] * keyframes[keyframe].odom_from_keyframe.Inverse();
    };
    const double gap = keyframes[after].time - keyframes[before].time;
    const double fraction =
        gap > 0 ? std::clamp((state.time - keyframes[before].time) / gap, 0.0, 1.0) : 0;
    const Rigid3 pose = state.world_from_body;
    state.world_from_body =
        Interpolate(moved_with(before) * pose, moved_with(after) * pose, fraction);
    const Eigen::Matrix3d turn =
        (state.world_from_body.rotation * pose.rotation.conjugate()).toRotationMatrix();
    state.velocity_in_world = (turn * state.velocity_in_world).eval();
    Matrix6d turned = Matrix6d::Identity();  // [rotation in body | position]
    turned.bottomRightCorner<3, 3>() = turn;
    state.covariance = (turned * state.covariance * turned.transpose()).eval();
  }
  return Trajectory(std::move(states));
}

LoopClosure CloseLoops(const DriveLog& log, const Trajectory& odometry, const LoopOptions& options,
                       const LoopReview& review, KeyframeStore& described) {
  options.Validate();
  const auto start = std::chrono::steady_clock::now();
  LoopClosure closure;
  closure.odom_from_body = odometry;
  if (options.method == "none" || odometry.states().size() < 2) return closure;
  const std::vector<RigKeyframe> keyframes = ChooseKeyframes(odometry, options.keyframes);
  closure.num_keyframes = static_cast<int>(keyframes.size());
  std::vector<bool> is_possible = FindPossibleRevisits(keyframes, options.recognition);
  const ReviewedLoops reviewed(review, keyframes.size());
  reviewed.MarkKeyframes(is_possible);
  if (std::count(is_possible.begin(), is_possible.end(), true) == 0) return closure;
  PlaceWords words;
  DescribeKeyframes(log, odometry, options.keyframes, is_possible, keyframes,
                    [&, index = size_t{0}](RigKeyframe&& keyframe) mutable {
                      words.Add(keyframe);
                      if (is_possible[index++]) described.Add(keyframe);
                    });
  std::vector<PlaceCandidate> candidates = RecognizePlaces(words, keyframes, options.recognition);
  words = {};
  reviewed.AddForced(candidates);
  MeasuredLoops measured = MeasureLoops(described, keyframes, candidates, options);
  closure.loops = std::move(measured.loops);
  closure.views = std::move(measured.views);
  for (LoopEvidence& loop : closure.loops) reviewed.Judge(loop);
  const std::vector<double> shares = SharesOf(closure.loops, keyframes, options.shared_reach);
  for (size_t i = 0; i < shares.size(); ++i) closure.loops[i].share = shares[i];
  const std::vector<Rigid3> poses =
      Optimize(keyframes, candidates, WithDriftOf(odometry, options), closure);
  for (size_t i = 0; i < keyframes.size(); ++i)
    closure.largest_correction =
        std::max(closure.largest_correction,
                 (poses[i].translation - keyframes[i].odom_from_keyframe.translation).norm());
  if (closure.num_accepted > 0) closure.odom_from_body = CarryAlong(odometry, keyframes, poses);
  closure.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return closure;
}

}  // namespace parkade
