#include "server/ingest/checks/pair_motion.h"

#include "core/rigid3.h"

namespace parkade {

Eigen::Vector3d WayOfCamera(const RigCamera& camera, const Eigen::Quaterniond& body_turn,
                            double way) {
  // The rear axle follows the chord of its arc; the camera swings about it.
  const Eigen::Vector3d lever = camera.body_from_camera.translation;
  const Eigen::Vector3d moved =
      ExpSo3(0.5 * LogSo3(body_turn)) * Eigen::Vector3d(way, 0, 0) + body_turn * lever - lever;
  return (camera.body_from_camera.rotation.conjugate() * moved).normalized();
}

}  // namespace parkade
