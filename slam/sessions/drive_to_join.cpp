#include "slam/sessions/drive_to_join.h"

#include <algorithm>

#include "core/error.h"

namespace parkade {

const std::vector<RigKeyframe>& DescribedDrives::KeyframesOf(size_t drive) {
  const DriveToJoin& asked = drives_[drive];
  if (!asked.describe) return asked.keyframes;
  const auto [described, is_new] = described_.try_emplace(drive);
  if (is_new) {
    described->second = asked.describe();
    Require(described->second.size() == asked.keyframes.size(), ErrorCode::kInternal,
            "a drive has other keyframes than it describes");
  }
  return described->second;
}

PlaceWords DescribedDrives::WordsOf(size_t drive) {
  return drives_[drive].words ? *drives_[drive].words : PlaceWords(KeyframesOf(drive));
}

int DrivePair::num_accepted() const {
  return static_cast<int>(
      std::count_if(weights.begin(), weights.end(), [](double weight) { return weight > 0.5; }));
}

double SquaredErrorOf(const SessionLoop& link, const Rigid3& frame_from_a,
                      const Rigid3& frame_from_b) {
  PoseGraphEdge measured;
  measured.from_from_to = link.pose.a_from_b;
  const Vector6d error = RelativePoseError(measured, frame_from_a, frame_from_b);
  return error.dot(link.pose.information * error);
}

void AddClosedLoops(const DriveToJoin& drive, size_t first_vertex, PoseGraph& graph) {
  const std::vector<RigKeyframe>& keyframes = drive.keyframes;
  for (const LoopEvidence& loop : drive.loops.loops) {
    if (loop.weight < 0.5 || loop.pose.information.diagonal().minCoeff() <= 0) continue;
    graph.edges.push_back({first_vertex + loop.earlier_keyframe, first_vertex + loop.later_keyframe,
                           keyframes[loop.earlier_keyframe].odom_from_keyframe.Inverse() *
                               keyframes[loop.later_keyframe].odom_from_keyframe,
                           loop.share * loop.pose.information, true});
  }
}

}  // namespace parkade
