#include "slam/sessions/settled_drives.h"

#include <algorithm>

#include "slam/pose_graph/chi_squared.h"
#include "slam/sessions/match_all_sessions.h"

namespace parkade {
namespace {

constexpr std::size_t kFewDrives = 8;

Rigid3 PoseAt(const Trajectory& trajectory, Timestamp time) {
  const TimeSpan span = trajectory.span();
  return *trajectory.At(std::clamp(time, span.begin, span.end));
}

std::vector<Rigid3> KeyframesIn(const DriveToJoin& drive, const Trajectory& site_from_body) {
  std::vector<Rigid3> poses;
  for (const RigKeyframe& keyframe : drive.keyframes)
    poses.push_back(PoseAt(site_from_body, keyframe.time) *
                    PoseAt(drive.odom_from_body, keyframe.time).Inverse() *
                    keyframe.odom_from_keyframe);
  return poses;
}

}  // namespace

SettledDrives::SettledDrives(const std::vector<DriveToJoin>& drives,
                             const std::vector<std::optional<Trajectory>>& site_from_body)
    : poses_(drives.size()) {
  for (std::size_t i = 0; i < std::min(drives.size(), site_from_body.size()); ++i)
    if (site_from_body[i]) poses_[i] = KeyframesIn(drives[i], *site_from_body[i]);
  while (first_ < poses_.size() && poses_[first_].empty()) ++first_;
}

bool SettledDrives::Weigh(std::vector<DrivePair>& pairs) const {
  std::vector<DrivePair> between;
  for (DrivePair& pair : pairs) {
    if (!HoldBoth(pair)) continue;
    for (std::size_t i = 0; i < pair.found.links.size(); ++i) {
      const SessionLoop& link = pair.found.links[i];
      pair.chi_squared[i] = SquaredErrorOf(link, poses_[pair.drive_a][link.keyframe_a],
                                           poses_[pair.drive_b][link.keyframe_b]);
      pair.weights[i] = pair.IsForced(i) || pair.chi_squared[i] < ChiSquared99(6) ? 1 : 0;
    }
    between.push_back(pair);
  }
  const std::vector<std::size_t> groups = FindGroups(poses_.size(), between);
  for (std::size_t i = 0; i < poses_.size(); ++i)
    if (Holds(i) && groups[i] != first_) return false;
  return true;
}

bool IsToBeSettled(std::size_t before, std::size_t now) {
  for (std::size_t mark = kFewDrives; mark <= now; mark *= 2)
    for (const std::size_t at : {mark, mark + mark / 2})
      if (before < at && at <= now) return true;
  return now <= kFewDrives;
}

}  // namespace parkade
