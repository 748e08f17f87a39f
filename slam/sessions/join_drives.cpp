#include "slam/sessions/join_drives.h"

#include <algorithm>
#include <chrono>

#include "core/error.h"
#include "slam/loops/close_loops.h"
#include "slam/loops/keyframe_graph.h"
#include "slam/pose_graph/robust_pose_graph.h"
#include "slam/sessions/forced_links.h"
#include "slam/sessions/match_all_sessions.h"
#include "slam/sessions/place_by_gnss.h"

namespace parkade {
namespace {

/// The link by which two drives are laid to each other at first: one that is not doubted, else any.
size_t StartLink(const DrivePair& pair) {
  const auto forced = std::find(pair.is_forced.begin(), pair.is_forced.end(), true);
  return forced != pair.is_forced.end() ? static_cast<size_t>(forced - pair.is_forced.begin())
                                        : pair.found.links.size() / 2;
}

/// Where the drives' odometry frames lie in that of the group's first drive, link by link; in that
/// of the settled drives if these are of the group. Empty for other drives.
std::vector<std::optional<Rigid3>> StartFrames(const std::vector<DriveToJoin>& drives,
                                               const std::vector<size_t>& groups, size_t group,
                                               const SettledDrives& settled,
                                               const std::vector<DrivePair>& pairs) {
  std::vector<std::optional<Rigid3>> group_from_odom(drives.size());
  for (size_t i = 0; i < drives.size(); ++i)
    if (groups[i] == group && settled.Holds(i))
      group_from_odom[i] =
          settled.PosesOf(i).front() * drives[i].keyframes.front().odom_from_keyframe.Inverse();
  if (settled.empty() || groups[settled.first()] != group) group_from_odom[group].emplace();
  for (bool is_changed = true; is_changed;) {
    is_changed = false;
    for (const DrivePair& pair : pairs) {
      std::optional<Rigid3>&a = group_from_odom[pair.drive_a], &b = group_from_odom[pair.drive_b];
      if (pair.num_accepted() == 0 || a.has_value() == b.has_value()) continue;
      const SessionLoop& link = pair.found.links[StartLink(pair)];
      const RigKeyframe& keyframe_a = drives[pair.drive_a].keyframes[link.keyframe_a];
      const RigKeyframe& keyframe_b = drives[pair.drive_b].keyframes[link.keyframe_b];
      const Rigid3 odom_a_from_b = keyframe_a.odom_from_keyframe * link.pose.a_from_b *
                                   keyframe_b.odom_from_keyframe.Inverse();
      if (a) {
        b = *a * odom_a_from_b;
      } else {
        a = *b * odom_a_from_b.Inverse();
      }
      is_changed = true;
    }
  }
  return group_from_odom;
}

/// \param poses  of all drives' keyframes, in their group
std::vector<GnssDrive> GnssOfGroup(const std::vector<DriveToJoin>& drives,
                                   const std::vector<size_t>& groups, size_t group,
                                   const std::vector<std::vector<Rigid3>>& poses) {
  std::vector<GnssDrive> placed;
  for (size_t i = 0; i < drives.size(); ++i) {
    if (groups[i] != group || !drives[i].gnss || poses[i].empty()) continue;
    GnssDrive& drive = placed.emplace_back(GnssDrive{*drives[i].gnss, {}, {}});
    for (const RigKeyframe& keyframe : drives[i].keyframes)
      drive.in_odom.push_back(keyframe.odom_from_keyframe.translation);
    for (const Rigid3& pose : poses[i]) drive.in_group.push_back(pose.translation);
  }
  return placed;
}

/// The group with the most drives, then with the longest way.
size_t ChooseGroup(const std::vector<DriveToJoin>& drives, const std::vector<size_t>& groups) {
  std::vector<std::pair<int, double>> sizes(drives.size());
  for (size_t i = 0; i < drives.size(); ++i) {
    ++sizes[groups[i]].first;
    sizes[groups[i]].second += drives[i].odom_from_body.Length();
  }
  return static_cast<size_t>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
}

/// All keyframes of some drives of a group as one graph, held by settled ones, else by the first
/// keyframe of its first drive.
class JointGraph {
 public:
  JointGraph(const std::vector<DriveToJoin>& drives,
             const std::vector<std::optional<Rigid3>>& group_from_odom,
             const SettledDrives& settled, const LoopOptions& options)
      : graph_(WorldGraph()), first_vertex_(drives.size()) {
    for (size_t i = 0; i < drives.size(); ++i) {
      if (!group_from_odom[i]) continue;
      const bool is_settled = settled.Holds(i);
      std::vector<Rigid3> poses = is_settled ? settled.PosesOf(i) : std::vector<Rigid3>();
      for (size_t k = poses.size(); k < drives[i].keyframes.size(); ++k)
        poses.push_back(*group_from_odom[i] * drives[i].keyframes[k].odom_from_keyframe);
      first_vertex_[i] = AddKeyframes(drives[i].keyframes, poses, options,
                                      kIdsPerDrive * static_cast<std::int64_t>(i), graph_);
      if (is_settled)
        Fix(first_vertex_[i]);
      else
        AddClosedLoops(drives[i], first_vertex_[i], graph_);
    }
    if (settled_vertices_.empty()) graph_.vertices[1].is_fixed = true;
  }

  void AddLinks(const DrivePair& pair) {
    first_link_.push_back(graph_.edges.size());
    for (size_t i = 0; i < pair.found.links.size(); ++i)
      graph_.edges.push_back(EdgeOf(pair, pair.found.links[i], pair.IsForced(i)));
  }

  /// Sets the weights of the pairs in the order in which their links were added.
  void Solve(const std::vector<DrivePair*>& pairs) {
    RobustPoseGraphOptions robust;
    robust.graph.objective = "information";
    robust.adapts_noise = false;
    const RobustPoseGraphSummary summary = OptimizePoseGraphRobustly(robust, graph_);
    for (size_t i = 0; i < pairs.size(); ++i) {
      for (size_t k = 0; k < pairs[i]->found.links.size(); ++k) {
        pairs[i]->weights[k] = summary.weights[first_link_[i] + k];
        pairs[i]->chi_squared[k] = summary.chi_squared[first_link_[i] + k];
      }
    }
  }

  std::vector<Rigid3> Poses(size_t drive, size_t num_keyframes) const {
    std::vector<Rigid3> poses;
    for (size_t i = 0; i < num_keyframes; ++i)
      poses.push_back(graph_.vertices[first_vertex_[drive] + i].world_from_vertex);
    return poses;
  }

 private:
  /// Holds all vertices from `first` on, to each other and to those that were held before.
  void Fix(size_t first) {
    for (size_t i = first; i < graph_.vertices.size(); ++i) graph_.vertices[i].is_fixed = true;
    if (!settled_vertices_.empty()) {
      const size_t other = settled_vertices_.back();
      graph_.edges.push_back({other, first,
                              graph_.vertices[other].world_from_vertex.Inverse() *
                                  graph_.vertices[first].world_from_vertex,
                              Matrix6d::Identity(), true});
    }
    settled_vertices_.push_back(first);
  }

  PoseGraphEdge EdgeOf(const DrivePair& pair, const SessionLoop& link, bool is_trusted) const {
    return {first_vertex_[pair.drive_a] + link.keyframe_a,
            first_vertex_[pair.drive_b] + link.keyframe_b, link.pose.a_from_b,
            link.pose.information, is_trusted};
  }

  PoseGraph graph_;
  std::vector<size_t> first_vertex_;      ///< per drive
  std::vector<size_t> first_link_;        ///< per pair: its first edge
  std::vector<size_t> settled_vertices_;  ///< the first of each settled drive
};

/// Pairs of a group whose links have a say in where drives lie: one of the two is not settled.
std::vector<DrivePair*> OpenPairs(const std::vector<size_t>& groups, size_t group,
                                  const SettledDrives& settled, std::vector<DrivePair>& pairs) {
  std::vector<DrivePair*> open;
  for (DrivePair& pair : pairs)
    if (groups[pair.drive_a] == group && pair.num_accepted() > 0 && !settled.HoldBoth(pair))
      open.push_back(&pair);
  return open;
}

/// Which drives of a group take part in solving it: all that are not settled, and what these are
/// linked with.
std::vector<bool> FindTakingPart(const std::vector<size_t>& groups, size_t group,
                                 const SettledDrives& settled,
                                 const std::vector<DrivePair*>& open) {
  std::vector<bool> take_part(groups.size());
  for (size_t i = 0; i < groups.size(); ++i) take_part[i] = groups[i] == group && !settled.Holds(i);
  for (const DrivePair* pair : open) take_part[pair->drive_a] = take_part[pair->drive_b] = true;
  return take_part;
}

/// Poses of the keyframes of the group's drives in the frame of its first one; weighs the links
/// between them.
void SolveGroup(const std::vector<DriveToJoin>& drives, const std::vector<size_t>& groups,
                size_t group, const LoopOptions& loops, const SettledDrives& settled,
                std::vector<DrivePair>& pairs, std::vector<std::vector<Rigid3>>& poses) {
  const std::vector<DrivePair*> open = OpenPairs(groups, group, settled, pairs);
  const std::vector<bool> take_part = FindTakingPart(groups, group, settled, open);
  std::vector<std::optional<Rigid3>> frames = StartFrames(drives, groups, group, settled, pairs);
  for (size_t i = 0; i < drives.size(); ++i)
    if (!take_part[i]) frames[i].reset();
  for (size_t i = 0; i < drives.size(); ++i)
    if (groups[i] == group && settled.Holds(i)) poses[i] = settled.PosesOf(i);
  if (std::find(take_part.begin(), take_part.end(), true) != take_part.end()) {
    JointGraph graph(drives, frames, settled, loops);
    for (const DrivePair* pair : open) graph.AddLinks(*pair);
    if (!open.empty()) graph.Solve(open);
    for (size_t i = 0; i < drives.size(); ++i)
      if (frames[i] && !settled.Holds(i)) poses[i] = graph.Poses(i, drives[i].keyframes.size());
  }
  // How far the links that a reviewer rejected are from what all others say.
  for (DrivePair& pair : pairs) {
    if (groups[pair.drive_a] != group || groups[pair.drive_b] != group) continue;
    for (RejectedLink& rejected : pair.rejected)
      rejected.chi_squared =
          SquaredErrorOf(rejected.link, poses[pair.drive_a][rejected.link.keyframe_a],
                         poses[pair.drive_b][rejected.link.keyframe_b]);
  }
}

/// All drives of a group at once.
JointAdjustment RefineGroup(const std::vector<DriveToJoin>& drives,
                            const std::vector<size_t>& groups, size_t group,
                            const LoopOptions& loops, const SettledDrives& settled,
                            std::vector<DrivePair>& pairs,
                            std::vector<std::vector<Rigid3>>& poses) {
  const std::vector<DrivePair*> open = OpenPairs(groups, group, settled, pairs);
  if (open.empty()) return {};
  const std::vector<bool> take_part = FindTakingPart(groups, group, settled, open);
  std::vector<std::vector<Rigid3>> group_from_keyframe(drives.size());
  for (size_t i = 0; i < drives.size(); ++i)
    if (take_part[i]) group_from_keyframe[i] = poses[i];
  const JointAdjustment adjustment =
      AdjustJointly(drives, loops, settled, open, group_from_keyframe);
  for (size_t i = 0; i < drives.size(); ++i)
    if (take_part[i]) poses[i] = std::move(group_from_keyframe[i]);
  return adjustment;
}

/// None where their links do not hold them together: then all are joined anew.
SettledDrives SettledOf(const std::vector<DriveToJoin>& drives,
                        const std::vector<std::optional<Trajectory>>& site_from_body,
                        std::vector<DrivePair>& pairs) {
  SettledDrives settled(drives, site_from_body);
  std::vector<DrivePair> weighed = pairs;
  if (settled.empty() || !settled.Weigh(weighed)) return {};
  pairs = std::move(weighed);
  return settled;
}

/// Moves the groups that have GNSS to where it puts them, which makes them one group. Returns the
/// group that is kept.
size_t PlaceGroups(const std::vector<DriveToJoin>& drives, std::vector<size_t>& groups,
                   std::vector<std::vector<Rigid3>>& poses) {
  std::vector<size_t> placed = groups;
  std::optional<size_t> on_earth;
  for (size_t group = 0; group < drives.size(); ++group) {
    const std::optional<Rigid3> site_from_group =
        PlaceByGnss(GnssOfGroup(drives, groups, group, poses));
    if (!site_from_group) continue;
    if (!on_earth) on_earth = group;
    for (size_t i = 0; i < drives.size(); ++i) {
      if (groups[i] != group) continue;
      placed[i] = *on_earth;
      for (Rigid3& pose : poses[i]) pose = *site_from_group * pose;
    }
  }
  groups = placed;
  return ChooseGroup(drives, groups);
}

/// The one with the most drives, of groups that links hold together and that GNSS has made one.
size_t LargestPart(const std::vector<size_t>& linked, const std::vector<size_t>& groups,
                   size_t group) {
  std::vector<int> counts(linked.size());
  for (size_t i = 0; i < linked.size(); ++i) counts[linked[i]] += groups[i] == group;
  return static_cast<size_t>(std::max_element(counts.begin(), counts.end()) - counts.begin());
}

/// Chosen by the drives that are kept: others that are left out may well fit it.
std::string ReasonFor(size_t drive, const std::vector<DrivePair>& pairs,
                      const std::vector<size_t>& groups, size_t group) {
  const DrivePair* nearest = nullptr;
  for (const DrivePair& pair : pairs) {
    if (pair.drive_a != drive && pair.drive_b != drive) continue;
    const size_t other = pair.drive_a == drive ? pair.drive_b : pair.drive_a;
    if (groups[other] == group &&
        (!nearest || pair.found.num_agreeing > nearest->found.num_agreeing))
      nearest = &pair;
  }
  if (!nearest) return "no other drive looks like it";
  return nearest->found.rejected.empty() ? "its links contradict those of other drives"
                                         : nearest->found.rejected;
}

}  // namespace

std::vector<RigKeyframe> KeyframesAlong(const Trajectory& odometry,
                                        const Trajectory& odom_from_body,
                                        const KeyframeOptions& options) {
  std::vector<RigKeyframe> keyframes = ChooseKeyframes(odometry, options);
  for (RigKeyframe& keyframe : keyframes)
    keyframe.odom_from_keyframe = LeveledPose(*odom_from_body.At(keyframe.time));
  return keyframes;
}

DriveJoin JoinDrives(const std::vector<DriveToJoin>& drives, const LoopOptions& loops,
                     const SessionLoopOptions& links, const PairFindings& known,
                     const ReviewedLinks& reviewed,
                     const std::vector<std::optional<Trajectory>>& settled_before) {
  links.Validate();
  const auto start = std::chrono::steady_clock::now();
  DriveJoin join;
  join.drives.resize(drives.size());
  if (drives.size() == 1) {
    join.drives[0].site_from_body = drives[0].odom_from_body.Transformed(
        drives[0].gnss ? drives[0].gnss->site_from_odom : Rigid3{});
    return join;
  }
  MatchedSessions matched = MatchAllSessions(drives, loops, links, known);
  join.pairs = std::move(matched.pairs);
  join.findings = std::move(matched.findings);
  for (DrivePair& pair : join.pairs) reviewed.Judge(pair);
  AddForcedLinks(reviewed, drives, loops, links, join.pairs);

  const SettledDrives settled = SettledOf(drives, settled_before, join.pairs);

  // Links that the joint graph rejects may leave drives apart that seemed to hang together.
  std::vector<size_t> groups = FindGroups(drives.size(), join.pairs), before;
  std::vector<std::vector<Rigid3>> poses(drives.size());
  while (groups != before) {
    for (size_t i = 0; i < drives.size(); ++i)
      if (groups[i] == i) SolveGroup(drives, groups, i, loops, settled, join.pairs, poses);
    before = groups;
    groups = FindGroups(drives.size(), join.pairs);
  }
  for (size_t i = 0; i < drives.size(); ++i) {
    if (groups[i] != i) continue;
    const JointAdjustment adjustment =
        RefineGroup(drives, groups, i, loops, settled, join.pairs, poses);
    if (adjustment.num_links > join.adjustment.num_links) join.adjustment = adjustment;
  }
  const std::vector<size_t> linked = groups;
  const size_t group = PlaceGroups(drives, groups, poses);
  const size_t most = LargestPart(linked, groups, group);
  for (size_t i = 0; i < drives.size(); ++i) {
    if (groups[i] == group) {
      join.drives[i].is_held_by_gnss_alone = linked[i] != most;
      join.drives[i].site_from_body =
          CarryAlong(drives[i].odom_from_body, drives[i].keyframes, poses[i]);
    } else {
      join.drives[i].left_out = ReasonFor(i, join.pairs, groups, group);
    }
  }
  join.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return join;
}

}  // namespace parkade
