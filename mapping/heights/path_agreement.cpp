#include "mapping/heights/path_agreement.h"

#include <cmath>
#include <limits>
#include <optional>

#include "mapping/heights/measure_heights_options.h"

namespace parkade {
namespace {

constexpr double kApart = 2.0;                                   // [m] between poses ...
constexpr double kApartTurned = 0.3;                             // [rad] ... or this
constexpr double kReach = MeasureHeightsOptions().max_distance;  // [m] of views
constexpr double kSquare = 8.0;      // [m] of the squares that poses are sorted into
constexpr double kDeckHeight = 1.5;  // [m] above or below: of another deck
constexpr double kMaxMove = 3e-3;    // [m] a third of what a height is known to at best
constexpr double kMaxTurn = 2e-4;    // [rad]

std::pair<int, int> SquareOf(const Eigen::Vector3d& place) {
  return {static_cast<int>(std::floor(place.x() / kSquare)),
          static_cast<int>(std::floor(place.y() / kSquare))};
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

PathAgreement::PathAgreement(std::span<const TimedPose> before, const Trajectory& now) {
  for (const TimedPose& pose_before : before) {
    const std::optional<Rigid3> pose = now.At(pose_before.time);
    is_whole_ = is_whole_ && pose.has_value();
    if (!pose) continue;
    squares_[SquareOf(pose->translation)].push_back(poses_.size());
    poses_.push_back({*pose, *pose * pose_before.world_from_frame.Inverse()});
  }
}

/// Calls `visit(pose, distance)` for all whose views may show a place.
template <typename Visitor>
void PathAgreement::VisitNear(const Eigen::Vector3d& point, const Visitor& visit) const {
  const Eigen::Vector3d reach(kReach, kReach, 0);
  const auto [low_x, low_y] = SquareOf(point - reach);
  const auto [high_x, high_y] = SquareOf(point + reach);
  for (int x = low_x; x <= high_x; ++x)
    for (int y = low_y; y <= high_y; ++y)
      if (const auto found = squares_.find({x, y}); found != squares_.end())
        for (const std::size_t i : found->second) {
          const Eigen::Vector3d apart = poses_[i].now.translation - point;
          const double distance = apart.head<2>().norm();
          if (distance <= kReach && std::abs(apart.z()) <= kDeckHeight) visit(poses_[i], distance);
        }
}

bool PathAgreement::HoldsAt(const Eigen::Vector3d& point_in_site) const {
  if (!is_whole_) return false;
  const Pose* nearest = nullptr;
  double least = std::numeric_limits<double>::max();
  VisitNear(point_in_site, [&](const Pose& pose, double distance) {
    if (distance < least) least = distance, nearest = &pose;
  });
  if (nearest == nullptr) return true;
  const Eigen::Vector3d before = nearest->now_from_before.Inverse() * point_in_site;
  bool holds = true;
  VisitNear(point_in_site, [&](const Pose& pose, double distance) {
    const double moved = (pose.now_from_before * before - point_in_site).norm();
    const double turned =
        pose.now_from_before.rotation.angularDistance(nearest->now_from_before.rotation);
    holds = holds && moved <= kMaxMove + kMaxTurn * distance && turned <= kMaxTurn;
  });
  return holds;
}

std::vector<Eigen::Vector3d> PathAgreement::Places() const {
  std::vector<Eigen::Vector3d> places;
  for (const Pose& pose : poses_)
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        places.emplace_back(pose.now.translation + 0.5 * kReach * Eigen::Vector3d(x, y, 0));
  return places;
}

}  // namespace parkade
