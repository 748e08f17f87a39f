#include "mapping/heights/path_agreement.h"

#include <cmath>
#include <map>
#include <optional>
#include <utility>

namespace parkade {
namespace {

constexpr double kApart = 2.0;     // [m] between poses
constexpr double kReach = 12.0;    // [m] between poses whose views measure a height together
constexpr double kMaxMove = 3e-3;  // [m] a third of what a height is known to at best
constexpr double kMaxTurn = 2e-4;  // [rad]

/// Poses by squares of kReach.
class PoseSquares {
 public:
  void Add(std::size_t pose, const Eigen::Vector3d& place) {
    squares_[SquareOf(place)].push_back(pose);
  }

  /// Calls `visit(pose)` for all that may lie within kReach, until it says false; says whether it
  /// never did.
  template <typename Visitor>
  bool VisitAround(const Eigen::Vector3d& place, const Visitor& visit) const {
    const auto [column, row] = SquareOf(place);
    for (int x = column - 1; x <= column + 1; ++x)
      for (int y = row - 1; y <= row + 1; ++y)
        if (const auto found = squares_.find({x, y}); found != squares_.end())
          for (const std::size_t pose : found->second)
            if (!visit(pose)) return false;
    return true;
  }

 private:
  static std::pair<int, int> SquareOf(const Eigen::Vector3d& place) {
    return {static_cast<int>(std::floor(place.x() / kReach)),
            static_cast<int>(std::floor(place.y() / kReach))};
  }

  std::map<std::pair<int, int>, std::vector<std::size_t>> squares_;
};

bool LieAlike(const Rigid3& a_from_b_before, const Rigid3& a_from_b_now) {
  return (a_from_b_now.translation - a_from_b_before.translation).norm() <= kMaxMove &&
         a_from_b_now.rotation.angularDistance(a_from_b_before.rotation) <= kMaxTurn;
}

}  // namespace

std::vector<TimedPose> SparsePoses(const Trajectory& site_from_body) {
  std::vector<TimedPose> poses;
  for (const TrajectoryState& state : site_from_body.states()) {
    const Rigid3& pose = state.world_from_body;
    if (poses.empty() ||
        (pose.translation - poses.back().world_from_frame.translation).norm() >= kApart)
      poses.push_back({state.time, pose});
  }
  return poses;
}

bool HoldAlong(std::span<const TimedPose> before, const Trajectory& now) {
  std::vector<Rigid3> poses_now;
  PoseSquares squares;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const std::optional<Rigid3> pose = now.At(before[i].time);
    if (!pose) return false;
    const Rigid3& pose_before = before[i].world_from_frame;
    const Rigid3 from_before = pose_before.Inverse(), from_now = pose->Inverse();
    const bool lies_alike = squares.VisitAround(pose_before.translation, [&](std::size_t other) {
      const Rigid3& other_before = before[other].world_from_frame;
      return (other_before.translation - pose_before.translation).norm() > kReach ||
             LieAlike(from_before * other_before, from_now * poses_now[other]);
    });
    if (!lies_alike) return false;
    poses_now.push_back(*pose);
    squares.Add(i, pose_before.translation);
  }
  return true;
}

}  // namespace parkade
