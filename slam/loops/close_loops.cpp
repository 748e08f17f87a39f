#include "slam/loops/close_loops.h"

#include <chrono>

#include "core/error.h"
#include "core/parallel.h"
#include "slam/baselines/relative_pose_baselines.h"
#include "slam/loops/keyframe_graph.h"
#include "slam/loops/loop_shares.h"
#include "slam/loops/reviewed_loops.h"
#include "slam/places/estimate_rig_pose.h"
#include "slam/places/widen_keyframe.h"
#include "slam/pose_graph/robust_pose_graph.h"

namespace parkade {
namespace {

// Below these no loop without scale is believed: two cameras do not hold together as four do.
constexpr double kFloorTranslation = 0.02;           // [m] across the direction, at least
constexpr double kFloorRotation = 0.1 * M_PI / 180;  // [rad]

/// Vertex 0 is the world, vertex i + 1 is keyframe i.
PoseGraph GraphOf(const std::vector<RigKeyframe>& keyframes, const LoopOptions& options) {
  PoseGraph graph = WorldGraph();
  std::vector<Rigid3> poses;
  poses.reserve(keyframes.size());
  for (const RigKeyframe& keyframe : keyframes) poses.push_back(keyframe.odom_from_keyframe);
  graph.vertices[AddKeyframes(keyframes, poses, options, 0, graph)].is_fixed = true;
  return graph;
}

/// The factor of the five-point method is between two cameras; the length of the way between them
/// is unknown. The evidence shows the odometry's length.
void MeasureWithoutScale(const RigKeyframe& earlier, const RigKeyframe& later,
                         const std::vector<FeatureMatch>& matches, const Rigid3& by_odometry,
                         const LoopOptions& options, LoopEvidence& loop) {
  const TwoViewPose pose = EstimateTwoViewPose(earlier, later, matches, options.relative_pose);
  loop.pose.num_matches = pose.num_matches;
  loop.pose.num_inliers = pose.num_inliers;
  loop.pose.num_camera_pairs = 1;
  loop.pose.rejected = pose.rejected;
  if (!pose.rejected.empty()) return;
  const Eigen::Vector3d baseline = by_odometry * pose.second_in_b - pose.first_in_a;
  const Eigen::Vector3d direction = pose.first_from_second.translation;
  const Rigid3 scaled{pose.first_from_second.rotation,
                      std::max(direction.dot(baseline), 0.01) * direction};
  loop.earlier_from_camera = {Eigen::Quaterniond::Identity(), pose.first_in_a};
  loop.later_from_camera = {Eigen::Quaterniond::Identity(), pose.second_in_b};
  loop.pose.a_from_b = loop.earlier_from_camera * scaled * loop.later_from_camera.Inverse();
  const double sigma =
      std::hypot(pose.direction_sigma * scaled.translation.norm(), kFloorTranslation);
  loop.pose.worst_sigma = sigma;
  loop.pose.information = ScaleLessInformation(
      scaled,
      pose.rotation_covariance + kFloorRotation * kFloorRotation * Eigen::Matrix3d::Identity(),
      sigma, options.method == "scale-less");
}

/// Keeps the images of the two cameras that share the most inliers.
void ShowViews(const RigKeyframe& earlier, const RigKeyframe& later, LoopEvidence& loop) {
  if (!loop.pose.inliers_of_cameras.empty()) {
    loop.earlier_camera = loop.pose.inliers_of_cameras.front().camera_a;
    loop.later_camera = loop.pose.inliers_of_cameras.front().camera_b;
  }
  const auto view_of = [](const RigKeyframe& keyframe, int camera) {
    const auto index = static_cast<size_t>(camera);
    return index < keyframe.views.size() ? keyframe.views[index] : cv::Mat();
  };
  loop.earlier_view = view_of(earlier, loop.earlier_camera);
  loop.later_view = view_of(later, loop.later_camera);
}

/// The pose by all cameras, with what the neighbors of both keyframes saw where that is asked for.
RelativePose MeasureRig(const std::vector<RigKeyframe>& keyframes, const PlaceCandidate& candidate,
                        const LoopOptions& options) {
  const RelativePoseOptions& how = options.relative_pose;
  if (options.neighbors == 0) {
    const RigKeyframe &earlier = keyframes[candidate.earlier], &later = keyframes[candidate.later];
    return EstimateRigPose(earlier, later, MatchKeyframes(earlier, later, how), how);
  }
  const auto reach = static_cast<size_t>(options.neighbors);
  const RigKeyframe earlier = WidenKeyframe(keyframes, candidate.earlier, reach),
                    later = WidenKeyframe(keyframes, candidate.later, reach);
  RelativePose pose = EstimateRigPose(earlier, later, MatchKeyframes(earlier, later, how), how);
  pose.information /=
      2 * options.neighbors + 1;  // points that several neighbors saw count more than once
  return pose;
}

/// Relative poses of all candidates, in their order.
std::vector<LoopEvidence> Measure(const std::vector<RigKeyframe>& keyframes,
                                  const std::vector<PlaceCandidate>& candidates,
                                  const LoopOptions& options) {
  return ParallelMap(candidates.size(), [&](size_t i) {
    const PlaceCandidate& candidate = candidates[i];
    const RigKeyframe &earlier = keyframes[candidate.earlier], &later = keyframes[candidate.later];
    LoopEvidence loop;
    loop.id = std::to_string(candidate.earlier) + "-" + std::to_string(candidate.later);
    loop.earlier_keyframe = candidate.earlier;
    loop.later_keyframe = candidate.later;
    loop.earlier = earlier.time;
    loop.later = later.time;
    loop.way = later.distance - earlier.distance;
    loop.score = candidate.score;
    const Rigid3 by_odometry = earlier.odom_from_keyframe.Inverse() * later.odom_from_keyframe;
    if (options.method == "rig") {
      loop.pose = MeasureRig(keyframes, candidate, options);
    } else {
      const std::vector<FeatureMatch> matches =
          MatchKeyframes(earlier, later, options.relative_pose);
      if (options.method == "pnp") {
        loop.pose = EstimatePnpPose(earlier, later, matches, options.relative_pose);
      } else {
        MeasureWithoutScale(earlier, later, matches, by_odometry, options, loop);
      }
    }
    ShowViews(earlier, later, loop);
    loop.odometry_disagreement = (loop.pose.a_from_b.translation - by_odometry.translation).norm();
    return loop;
  });
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
                       const LoopReview& review,
                       const std::function<void(const RigKeyframe&)>& keep) {
  options.Validate();
  const auto start = std::chrono::steady_clock::now();
  LoopClosure closure;
  closure.odom_from_body = odometry;
  if (options.method == "none" || odometry.states().size() < 2) return closure;
  std::vector<RigKeyframe> keyframes = ChooseKeyframes(odometry, options.keyframes);
  closure.num_keyframes = static_cast<int>(keyframes.size());
  std::vector<bool> is_possible = FindPossibleRevisits(keyframes, options.recognition);
  const ReviewedLoops reviewed(review, keyframes.size());
  reviewed.MarkKeyframes(is_possible);
  if (std::count(is_possible.begin(), is_possible.end(), true) == 0) return closure;
  std::vector<RigKeyframe> chosen = std::exchange(keyframes, {});
  DescribeKeyframes(log, odometry, options.keyframes, is_possible, std::move(chosen),
                    [&](RigKeyframe&& keyframe) {
                      if (keep && is_possible[keyframes.size()]) keep(keyframe);
                      keyframe.floor.release();  // is for joining drives
                      keyframes.push_back(std::move(keyframe));
                    });
  std::vector<PlaceCandidate> candidates = RecognizePlaces(keyframes, options.recognition);
  reviewed.AddForced(candidates);
  closure.loops = Measure(keyframes, candidates, options);
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
