#include "mapping/heights/path_agreement.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "mapping/heights/measure_heights_options.h"

namespace parkade {
namespace {

constexpr double kApart = 2.0;                                       // [m] between poses ...
constexpr double kApartTurned = 0.3;                                 // [rad] ... or this
constexpr double kReach = 2 * MeasureHeightsOptions().max_distance;  // [m] between such poses
constexpr double kNear = 12.0;     // [m] between poses whose views share most of the ground
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
  const double beyond = std::max(0.0, a_from_b_before.translation.norm() - kNear);
  return (a_from_b_now.translation - a_from_b_before.translation).norm() <=
             kMaxMove + kMaxTurn * beyond &&
         a_from_b_now.rotation.angularDistance(a_from_b_before.rotation) <= kMaxTurn;
}

}  // namespace

std::vector<TimedPose> SparsePoses(const Trajectory& site_from_body) {
  std::vector<TimedPose> poses;
  const std::vector<TrajectoryState>& states = site_from_body.states();
  for (const TrajectoryState& state : states) {
    const Rigid3& pose = state.world_from_body;
    const bool is_last = &state == &states.back();
    if (poses.empty() || is_last ||
        (pose.translation - poses.back().world_from_frame.translation).norm() >= kApart ||
        pose.rotation.angularDistance(poses.back().world_from_frame.rotation) >= kApartTurned)
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
