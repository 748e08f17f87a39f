#include "mapping/driven_path.h"

namespace parkade {

DrivenPath MakeDrivenPath(int drive, const Rig& rig, const Trajectory& site_from_body, const Rigid3& body_from_ground) {
  DrivenPath path{drive, site_from_body, body_from_ground, ContactArea::Of(rig), {}};
  for (const RigCamera& camera : rig.cameras) path.cameras_in_body.push_back(camera.body_from_camera.translation);
  return path;
}

std::vector<ContactPoint> FindContacts(const DrivenPath& path, double spacing) {
  std::vector<ContactPoint> contacts;
  const Rigid3* last = nullptr;
  for (const TrajectoryState& state : path.site_from_body.states()) {
    if (last != nullptr && (state.odom_from_body.translation - last->translation).norm() < spacing) continue;
    last = &state.odom_from_body;
    const Rigid3 site_from_ground = state.odom_from_body * path.body_from_ground;
    const double half_track = 0.5 * path.contact.track;
    contacts.push_back({site_from_ground * Eigen::Vector3d(0, half_track, 0), false});
    if (half_track > 0) contacts.push_back({site_from_ground * Eigen::Vector3d(0, -half_track, 0), false});
    if (path.contact.wheelbase <= 0) continue;
    contacts.push_back({site_from_ground * Eigen::Vector3d(path.contact.wheelbase, half_track, 0), true});
    if (half_track > 0)
      contacts.push_back({site_from_ground * Eigen::Vector3d(path.contact.wheelbase, -half_track, 0), true});
  }
  return contacts;
}

}  // namespace parkade
