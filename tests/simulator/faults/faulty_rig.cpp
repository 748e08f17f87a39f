#include "tests/simulator/faults/faulty_rig.h"

#include <cmath>

#include "tests/simulator/common/random.h"

namespace parkade::simulator {
namespace {

Eigen::Vector3d RandomDirection(Random& random) {
  const double x = random.Normal(), y = random.Normal(), z = random.Normal();
  return Eigen::Vector3d(x, y, z).normalized();
}

}  // namespace

Rig TrueRig(const Rig& rig, const FaultOptions& faults) {
  Rig result = rig;
  for (size_t camera = 0; camera < rig.cameras.size(); ++camera)
    result.cameras[camera].time_shift = OfCamera(faults.time_offsets, camera);
  return result;
}

Rig NominalRig(const Rig& true_rig, const FaultOptions& faults, std::uint64_t seed) {
  Rig nominal = true_rig;
  for (size_t index = 0; index < nominal.cameras.size(); ++index) {
    RigCamera& camera = nominal.cameras[index];
    Random random(seed, 0xe00 + index);
    const Eigen::Vector3d axis = RandomDirection(random), direction = RandomDirection(random);
    const double angle = OfCamera(faults.extrinsic_rotation_deg, index) * M_PI / 180;
    camera.body_from_camera.rotation =
        (camera.body_from_camera.rotation * ExpSo3(angle * axis)).normalized();
    camera.body_from_camera.translation +=
        0.01 * OfCamera(faults.extrinsic_translation_cm, index) * direction;
    camera.time_shift = 0;
    if (faults.hides_line_delay) camera.line_delay = 0;
  }
  return nominal;
}

RigCamera KnockedCamera(const RigCamera& camera, double angle_deg) {
  // The hinge is where the mirror meets the door: a hand's breadth inwards, and tilted as doors
  // are.
  const Eigen::Vector3d& place = camera.body_from_camera.translation;
  const Eigen::Vector3d hinge = place + Eigen::Vector3d(0.05, place.y() > 0 ? -0.15 : 0.15, 0);
  const Eigen::Vector3d axis = Eigen::Vector3d(0.15, 0.1, 1).normalized();
  const Eigen::Quaterniond turn = ExpSo3(angle_deg * M_PI / 180 * axis);
  RigCamera knocked = camera;
  knocked.body_from_camera = Rigid3{turn, hinge - turn * hinge} * camera.body_from_camera;
  return knocked;
}

}  // namespace parkade::simulator
