#include "mapping/observation/camera_placement.h"

#include <algorithm>

namespace parkade {
namespace {

constexpr double kMaxTurn = 3e-4;  // [rad] half of what refinement knows it to
constexpr double kMaxMove = 2e-3;  // [m] a quarter

bool SeesAlike(const CameraPlacement& before, const CameraPlacement& now) {
  const Rigid3 moved = before.body_from_camera.Inverse() * now.body_from_camera;
  return Eigen::AngleAxisd(moved.rotation).angle() <= kMaxTurn &&
         moved.translation.norm() <= kMaxMove && now.time_shift == before.time_shift &&
         now.line_delay == before.line_delay;
}

}  // namespace

std::vector<CameraPlacement> PlacementsOf(const Rig& rig) {
  std::vector<CameraPlacement> placements;
  for (const RigCamera& camera : rig.cameras)
    placements.push_back({camera.body_from_camera, camera.time_shift, camera.line_delay});
  return placements;
}

bool SeeAlike(std::span<const CameraPlacement> before, std::span<const CameraPlacement> now) {
  return std::equal(before.begin(), before.end(), now.begin(), now.end(), SeesAlike);
}

}  // namespace parkade
