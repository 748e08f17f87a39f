#include "slam/loops/site_graph.h"

#include <algorithm>
#include <set>
#include <string>

#include "core/error.h"
#include "slam/loops/keyframe_graph.h"
#include "slam/pose_graph/robust_pose_graph.h"

namespace parkade {
namespace {

constexpr double kHardlyHeld =
    1e-4;  // [1/m^2], [1/rad^2] of a drive's first keyframe: all there is without links

std::set<std::string> BelievedLoops(const LoopClosure& closure) {
  std::set<std::string> ids;
  for (const LoopEvidence& loop : closure.loops)
    if (loop.weight > 0.5) ids.insert(loop.id);
  return ids;
}

bool HasScale(const LoopEvidence& loop) { return loop.pose.information.diagonal().minCoeff() > 0; }

/// The pose at a moment of the drive; at an end of the drive where rounding put the moment outside.
Rigid3 KeyframeAt(const Trajectory& trajectory, Timestamp time) {
  const TimeSpan span = trajectory.span();
  return LeveledPose(*trajectory.At(std::clamp(time, span.begin, span.end)));
}

std::vector<Rigid3> KeyframesAt(const Trajectory& trajectory,
                                const std::vector<RigKeyframe>& keyframes) {
  std::vector<Rigid3> poses;
  for (const RigKeyframe& keyframe : keyframes)
    poses.push_back(KeyframeAt(trajectory, keyframe.time));
  return poses;
}

void AddDrive(const RevisitedDrive& drive, const LoopOptions& options, SiteGraph& site) {
  std::vector<RigKeyframe> keyframes = ChooseKeyframes(drive.odometry, options.keyframes);
  Require(!keyframes.empty() && !drive.site_from_body.empty(), ErrorCode::kInvalidInput,
          "a drive of the site is empty");
  const std::vector<Rigid3> before = KeyframesAt(drive.site_from_body, keyframes);
  const bool keeps_shape = !drive.HasLost();
  std::vector<Rigid3> start = before;
  if (keeps_shape) {
    for (size_t i = 0; i < keyframes.size(); ++i) keyframes[i].odom_from_keyframe = before[i];
  } else {
    start = KeyframesAt(drive.after.odom_from_body, keyframes);
    const Rigid3 site_from_odom = before.front() * start.front().Inverse();
    for (Rigid3& pose : start) pose = site_from_odom * pose;
  }
  PoseGraph& graph = site.graph;
  const size_t first =
      AddKeyframes(keyframes, start, WithDriftOf(drive.odometry, options),
                   kIdsPerDrive * static_cast<std::int64_t>(site.first_vertex.size()), graph);
  graph.edges.push_back({0, first, start.front(), kHardlyHeld * Matrix6d::Identity(), true});
  const std::set<std::string> old_loops = BelievedLoops(drive.before);
  for (const LoopEvidence& loop : drive.after.loops) {
    if (loop.weight < 0.5 || !HasScale(loop)) continue;
    // The refined shape has old loops closed: they only hold it together as firmly as they were
    // measured.
    const bool is_closed = keeps_shape && old_loops.contains(loop.id);
    const Rigid3 pose = is_closed
                            ? before[loop.earlier_keyframe].Inverse() * before[loop.later_keyframe]
                            : loop.pose.a_from_b;
    graph.edges.push_back({first + loop.earlier_keyframe, first + loop.later_keyframe, pose,
                           loop.share * loop.pose.information, true});
  }
  site.first_vertex.push_back(first);
  site.before.insert(site.before.end(), before.begin(), before.end());
}

void AddLinks(std::span<const KeptLink> links, SiteGraph& site) {
  const auto end_of = [&](size_t drive) {
    return drive + 1 < site.first_vertex.size() ? site.first_vertex[drive + 1]
                                                : site.graph.vertices.size();
  };
  for (const KeptLink& link : links) {
    const size_t a = site.first_vertex.at(link.drive_a) + link.keyframe_a;
    const size_t b = site.first_vertex.at(link.drive_b) + link.keyframe_b;
    Require(a < end_of(link.drive_a) && b < end_of(link.drive_b), ErrorCode::kInvalidInput,
            "a link of the site is to a place that its drive does not have");
    site.graph.edges.push_back({a, b, link.a_from_b, link.information, false});
  }
}

/// Leaves out the links that are not believed.
void Solve(bool has_links, SiteGraph& site) {
  RobustPoseGraphOptions options;
  options.graph.objective = "information";
  options.adapts_noise = false;
  if (!has_links) {
    OptimizePoseGraph(options.graph, site.graph);
    return;
  }
  const std::vector<double> weights = OptimizePoseGraphRobustly(options, site.graph).weights;
  std::vector<PoseGraphEdge> believed;
  for (size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] < 0.5) continue;
    believed.push_back(site.graph.edges[i]);
    site.num_links += !site.graph.edges[i].is_trusted;
  }
  site.graph.edges = std::move(believed);
}

}  // namespace

bool RevisitedDrive::HasChanged() const { return BelievedLoops(before) != BelievedLoops(after); }

bool RevisitedDrive::HasLost() const {
  const std::set<std::string> was = BelievedLoops(before), is = BelievedLoops(after);
  return !std::includes(is.begin(), is.end(), was.begin(), was.end());
}

SiteGraph RegraphSite(std::span<const RevisitedDrive> drives, std::span<const KeptLink> links,
                      const LoopOptions& options) {
  Require(!drives.empty(), ErrorCode::kInvalidInput, "the site has no drives");
  SiteGraph site{WorldGraph(), {Rigid3{}}, {}, 0};
  for (const RevisitedDrive& drive : drives) AddDrive(drive, options, site);
  site.graph.vertices[1].is_fixed = true;
  AddLinks(links, site);
  Solve(!links.empty(), site);
  return site;
}

}  // namespace parkade
