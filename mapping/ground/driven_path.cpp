#include "mapping/ground/driven_path.h"

namespace parkade {
namespace {

constexpr double kHalfStep = 0.3;  // [s] to each side, over which acceleration is taken

}  // namespace

DrivenPath MakeDrivenPath(int drive, const Rig& rig, const Trajectory& site_from_body,
                          const Rigid3& body_from_ground) {
  DrivenPath path{drive, site_from_body, body_from_ground, WheelbaseFootprint::Of(rig), {}, {}, 1};
  for (const RigCamera& camera : rig.cameras)
    path.cameras_in_body.push_back(camera.body_from_camera.translation);
  return path;
}

Eigen::Vector2d AccelerationAt(const Trajectory& site_from_body, Timestamp time) {
  const auto before = site_from_body.At(time - kHalfStep), now = site_from_body.At(time),
             after = site_from_body.At(time + kHalfStep);
  if (!before || !now || !after) return Eigen::Vector2d::Zero();
  const Eigen::Vector3d in_site =
      (before->translation - 2 * now->translation + after->translation) / (kHalfStep * kHalfStep);
  return (now->rotation.inverse() * in_site).head<2>();
}

std::vector<ContactPoint> FindContacts(const DrivenPath& path, double spacing) {
  std::vector<ContactPoint> contacts;
  const Rigid3* last = nullptr;
  for (const TrajectoryState& state : path.site_from_body.states()) {
    if (last != nullptr && (state.world_from_body.translation - last->translation).norm() < spacing)
      continue;
    last = &state.world_from_body;
    const Rigid3 site_from_ground = state.world_from_body * path.body_from_ground;
    // Between the wheels of an axle the road is as good as known: it joins the two tracks to one
    // strip.
    const double half_track = 0.5 * path.contact.track;
    const std::vector<double> across =
        half_track > 0 ? std::vector{half_track, 0.0, -half_track} : std::vector{0.0};
    const Eigen::Vector2d acceleration = AccelerationAt(path.site_from_body, state.time);
    const auto contact_at = [&](double x, double y) {
      return site_from_ground * Eigen::Vector3d(x, y, -path.lean.LiftAt(acceleration, {x, y}));
    };
    for (const double y : across) {
      contacts.push_back({contact_at(0, y), false});
      if (path.contact.wheelbase > 0)
        contacts.push_back({contact_at(path.contact.wheelbase, y), true});
    }
  }
  return contacts;
}

}  // namespace parkade
