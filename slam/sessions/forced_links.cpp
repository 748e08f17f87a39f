#include "slam/sessions/forced_links.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace parkade {
namespace {

constexpr int kMinInliers = 6;  // fewer fix no pose, whatever a reviewer wants

std::optional<SessionLoop> Measure(const LinkEnds& ends, DescribedDrives& drives,
                                   const LoopOptions& loops, const SessionLoopOptions& options) {
  const auto &a = drives.KeyframesOf(ends.drive_a), &b = drives.KeyframesOf(ends.drive_b);
  if (ends.keyframe_a >= a.size() || ends.keyframe_b >= b.size()) return std::nullopt;
  SessionLoop link =
      MeasureLink(a, b, {ends.keyframe_a, ends.keyframe_b, 0}, options, loops.relative_pose);
  if (link.pose.num_inliers < kMinInliers || link.pose.information.diagonal().minCoeff() <= 0)
    return std::nullopt;
  link.pose.rejected = "";
  return link;
}

DrivePair& PairOf(const LinkEnds& ends, std::vector<DrivePair>& pairs) {
  const auto key = [](size_t drive_a, size_t drive_b) { return std::pair(drive_b, drive_a); };
  const auto found = std::find_if(pairs.begin(), pairs.end(), [&](const DrivePair& pair) {
    return key(pair.drive_a, pair.drive_b) >= key(ends.drive_a, ends.drive_b);
  });
  if (found != pairs.end() && found->drive_a == ends.drive_a && found->drive_b == ends.drive_b)
    return *found;
  return *pairs.insert(found, {ends.drive_a, ends.drive_b, {}, {}, {}});
}

}  // namespace

void AddForcedLinks(const ReviewedLinks& reviewed, const std::vector<DriveToJoin>& drives,
                    const LoopOptions& loops, const SessionLoopOptions& options,
                    std::vector<DrivePair>& pairs) {
  DescribedDrives described(drives);
  for (const LinkEnds& ends : reviewed.forced()) {
    DrivePair& pair = PairOf(ends, pairs);
    if (HasLink(pair, ends)) continue;
    std::optional<SessionLoop> link = Measure(ends, described, loops, options);
    if (!link) continue;
    pair.is_forced.resize(pair.found.links.size());
    pair.is_forced.push_back(true);
    pair.found.links.push_back(std::move(*link));
    pair.found.rejected = "";
    pair.weights.push_back(1);
    pair.chi_squared.push_back(0);
  }
}

}  // namespace parkade
