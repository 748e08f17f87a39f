#include "mapping/heights/tied_heights.h"

#include <cmath>
#include <limits>

namespace parkade {
namespace {

constexpr double kPoseDistance = 0.5;  // [m] between poses that heights may be tied to
constexpr double kPoseSquare = 8.0;    // [m] of the squares in which these are sorted

std::pair<int, int> SquareOf(const Eigen::Vector3d& point) {
  return {static_cast<int>(std::floor(point.x() / kPoseSquare)),
          static_cast<int>(std::floor(point.y() / kPoseSquare))};
}

}  // namespace

PoseTies::PoseTies(const Trajectory* site_from_body) {
  if (site_from_body == nullptr) return;
  const TrajectoryState* last = nullptr;
  for (const TrajectoryState& state : site_from_body->states()) {
    const Eigen::Vector3d& place = state.world_from_body.translation;
    if (last && (place - last->world_from_body.translation).norm() < kPoseDistance) continue;
    last = &state;
    poses_.push_back(&state);
    squares_[SquareOf(place)].push_back(&state);
  }
}

DriveHeight PoseTies::Tie(const HeightObservation& height) const {
  DriveHeight tied{{},
                   height.point_in_site.cast<float>(),
                   static_cast<float>(height.weight),
                   static_cast<float>(height.sigma)};
  if (const TrajectoryState* pose = NearestTo(height.point_in_site)) {
    tied.time = pose->time;
    tied.point_in_body = (pose->world_from_body.Inverse() * height.point_in_site).cast<float>();
  }
  return tied;
}

const TrajectoryState* PoseTies::NearestTo(const Eigen::Vector3d& point) const {
  const TrajectoryState* nearest = nullptr;
  double least = std::numeric_limits<double>::max();
  const auto look = [&](const std::vector<const TrajectoryState*>& poses) {
    for (const TrajectoryState* pose : poses) {
      const double distance = (pose->world_from_body.translation - point).squaredNorm();
      if (distance < least) least = distance, nearest = pose;
    }
  };
  const auto [x, y] = SquareOf(point);
  for (int reach = 1; reach <= 2 && least > reach * reach * kPoseSquare * kPoseSquare; ++reach)
    for (int sx = x - reach; sx <= x + reach; ++sx)
      for (int sy = y - reach; sy <= y + reach; ++sy)
        if (const auto found = squares_.find({sx, sy}); found != squares_.end())
          look(found->second);
  if (nearest == nullptr) look(poses_);
  return nearest;
}

std::optional<Eigen::Vector3d> TiedPoints::InSite(const DriveHeight& height) {
  const Eigen::Vector3d point = height.point_in_body.cast<double>();
  if (path_ == nullptr) return point;
  const auto [found, is_new] = poses_.try_emplace(height.time.ns);
  if (is_new) found->second = path_->At(height.time);
  if (!found->second) return std::nullopt;
  return *found->second * point;
}

}  // namespace parkade
