#include "tests/simulator/row_poses.h"

#include <algorithm>

namespace parkade::simulator {
namespace {

/// Moments of the four samples within the exposure, in units of it. They grow with the samples' places along the row:
/// what moves to the right by a pixel in an exposure has a hard edge, what moves to the left a soft one.
constexpr std::array<double, kSamplesPerPixel> kMoments = {-0.125, 0.375, -0.375, 0.125};

/// From the middle of the picture [s].
double RowOffset(const RigCamera& camera, int row) {
  return camera.line_delay * (row - (camera.model.height() - 1) / 2.0);
}

}  // namespace

double PictureHalfTime(const RigCamera& camera, const Shot& shot) {
  return RowOffset(camera, camera.model.height()) + shot.exposure / 2 + 1e-6;
}

RowPoses PosesOfRow(const RigCamera& camera, const Shot& shot, int row) {
  const double row_offset = RowOffset(camera, row), half_picture = PictureHalfTime(camera, shot);
  RowPoses poses;
  Eigen::Vector3d first = Eigen::Vector3d::Zero(), last = first;
  for (size_t sample = 0; sample < kSamplesPerPixel; ++sample) {
    const Rigid3 world_from_body = shot.world_from_body(row_offset + kMoments[sample] * shot.exposure);
    poses.world_from_body[sample] = FastPose(world_from_body);
    poses.body_from_world[sample] = FastPose(world_from_body.Inverse());
    poses.world_from_camera[sample] = FastPose(world_from_body * camera.body_from_camera);
    poses.time[sample] = static_cast<float>(
        std::clamp(0.5 + 0.5 * (row_offset + kMoments[sample] * shot.exposure) / half_picture, 0.0, 1.0));
    if (sample == 1) last = world_from_body.translation;
    if (sample == 2) first = world_from_body.translation;
  }
  if (shot.exposure > 0) poses.speed = static_cast<float>((last - first).norm() / (0.75 * shot.exposure));
  return poses;
}

}  // namespace parkade::simulator
