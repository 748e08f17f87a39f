#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/geo.h"
#include "core/ground_markings.h"
#include "core/ground_texture.h"
#include "core/rig.h"
#include "core/surface_map.h"
#include "core/trajectory.h"
#include "core/triangle_mesh.h"

namespace parkade {

/// One drive within a site.
struct SiteDrive {
  std::string name;  ///< unique within the site; letters, digits, '-', '_', '.'
  Rig rig;
  Trajectory odometry;                   ///< odom_from_body
  Trajectory site_from_body_trajectory;  ///< final
};

/// Everything that `export/` writes and the API reads.
struct SiteMap {
  std::vector<SiteDrive> drives;
  SurfaceMap surface;
  TriangleMesh mesh;
  GroundTexture texture;                   ///< of `mesh`; may be empty
  GroundMarkings markings;                 ///< ParkingSlot::states by `drives`
  std::optional<SiteDatum> datum;          ///< empty: arbitrary origin and yaw
  std::optional<SitePlacement> placement;  ///< how well the datum is known; empty: not known
};

}  // namespace parkade
