#include "tests/simulator/rays/row_poses.h"

#include <algorithm>

namespace parkade::simulator {
namespace {

/// From the middle of the image [s].
double RowOffset(const RigCamera& camera, int row) {
  return camera.line_delay * (row - (camera.model.height() - 1) / 2.0);
}

FastPose Between(const FastPose& first, const FastPose& last, float share) {
  FastPose pose;
  pose.rotation = (1 - share) * first.rotation + share * last.rotation;
  pose.translation = (1 - share) * first.translation + share * last.translation;
  return pose;
}

}  // namespace

double ImageHalfTime(const RigCamera& camera, const Shot& shot) {
  return RowOffset(camera, camera.model.height()) + shot.exposure / 2 + 1e-6;
}

RowPoses PosesOfRow(const RigCamera& camera, const Shot& shot, int row) {
  const double middle = RowOffset(camera, row), half_image = ImageHalfTime(camera, shot);
  const double reach =
      0.5 * (1 - 1.0 / kNumMoments) * shot.exposure;  // [s] of the first and the last moment
  const Rigid3 world_from_body_first = shot.world_from_body(middle - reach),
               world_from_body_last = shot.world_from_body(middle + reach);
  const auto all = [&](auto&& of) {
    return std::array<FastPose, 2>{FastPose(of(world_from_body_first)),
                                   FastPose(of(world_from_body_last))};
  };
  const auto world_from_body = all([](const Rigid3& pose) { return pose; });
  const auto body_from_world = all([](const Rigid3& pose) { return pose.Inverse(); });
  const auto world_from_camera =
      all([&](const Rigid3& pose) { return pose * camera.body_from_camera; });
  RowPoses poses;
  for (int moment = 0; moment < kNumMoments; ++moment) {
    const double share = moment / (kNumMoments - 1.0), offset = middle + (2 * share - 1) * reach;
    MomentPose& pose = poses.moments[static_cast<size_t>(moment)];
    pose.world_from_body =
        Between(world_from_body[0], world_from_body[1], static_cast<float>(share));
    pose.body_from_world =
        Between(body_from_world[0], body_from_world[1], static_cast<float>(share));
    pose.world_from_camera =
        Between(world_from_camera[0], world_from_camera[1], static_cast<float>(share));
    pose.time = static_cast<float>(std::clamp(0.5 + 0.5 * offset / half_image, 0.0, 1.0));
  }
  if (reach > 0)
    poses.speed = static_cast<float>(
        (world_from_body_last.translation - world_from_body_first.translation).norm() /
        (2 * reach));
  return poses;
}

}  // namespace parkade::simulator
