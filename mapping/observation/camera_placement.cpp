#include "mapping/observation/camera_placement.h"

#include <algorithm>
#include <cmath>

namespace parkade {
namespace {

constexpr double kMaxTurn = 1e-4;       // [rad]
constexpr double kMaxMove = 1e-3;       // [m]
constexpr double kMaxDelay = 2e-4;      // [s] at 3 m/s and 0.5 rad/s half a millimeter, 0.1 mrad
constexpr double kMaxLineDelay = 5e-7;  // [s/row] of which an image has some hundred

bool SeesAlike(const CameraPlacement& before, const CameraPlacement& now) {
  const Rigid3 moved = before.body_from_camera.Inverse() * now.body_from_camera;
  return Eigen::AngleAxisd(moved.rotation).angle() <= kMaxTurn &&
         moved.translation.norm() <= kMaxMove &&
         std::abs(now.time_shift - before.time_shift) <= kMaxDelay &&
         std::abs(now.line_delay - before.line_delay) <= kMaxLineDelay;
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
