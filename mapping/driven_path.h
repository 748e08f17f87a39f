#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <span>
#include <vector>

#include "core/rig.h"
#include "core/trajectory.h"
#include "mapping/contact_area.h"

namespace parkade {

/// One drive through the site, as the ground needs it: where its wheels stood and where its cameras were.
struct DrivenPath {
  int drive = 0;              ///< as GroundPatch::drive
  Trajectory site_from_body;  ///< final
  Rigid3 body_from_ground;    ///< of GroundObservation
  ContactArea contact;
  std::vector<Eigen::Vector3d> cameras_in_body;  ///< [m] optical centres, indexed as GroundPatch::camera
};

/// The path of a drive among `paths`; null where there is none.
inline const DrivenPath* FindPath(std::span<const DrivenPath> paths, int drive) {
  const auto found = std::find_if(paths.begin(), paths.end(), [&](const DrivenPath& p) { return p.drive == drive; });
  return found == paths.end() ? nullptr : &*found;
}

DrivenPath MakeDrivenPath(int drive, const Rig& rig, const Trajectory& site_from_body, const Rigid3& body_from_ground);

/// A point of the road under an axle or, without a known car, under the body.
struct ContactPoint {
  Eigen::Vector3d point_in_site;
  bool is_front = false;  ///< of the front axle: the suspension's pitch acts there
};

/// Contacts about every `spacing` [m] of travel; one set at standstill.
std::vector<ContactPoint> FindContacts(const DrivenPath& path, double spacing);

}  // namespace parkade
