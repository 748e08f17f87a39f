#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "core/geo.h"

namespace parkade {

/// How Autoware gets from degrees to meters: `LocalCartesian`, a tangent plane of WGS84 as the site
/// is, for a map on Earth, and `Local` for any other. MGRS, LocalCartesianUTM and
/// TransverseMercator are maps whose meters are up to 0.04 % off and whose north is turned by up to
/// some degrees: point clouds in site would not fit them.
///
/// Autoware sets the origin's altitude to 0 whatever the file says
/// (autoware_map_projection_loader). Hence altitudes are written relative to the site's origin, and
/// Autoware's x, y and z are the site's. Degrees are those that this projection needs: beside
/// WGS84's, they are scaled by the origin's altitude over the Earth's radius, 8 mm in 100 m at 500
/// m.
class MapProjector {
 public:
  explicit MapProjector(const std::optional<SiteDatum>& datum);

  /// Degrees, and the altitude [m] that Autoware turns into z. Without a datum they are near 0 N
  /// 0 E, where only editors look at them, and the altitude is z itself.
  Geodetic Unproject(const Eigen::Vector3d& point_in_site) const;

  /// map_projector_info.yaml
  std::string EncodeInfo() const;

 private:
  std::optional<SiteDatum> datum_;
  SiteDatum origin_;  ///< at altitude 0
};

}  // namespace parkade
