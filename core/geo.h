#pragma once

#include <Eigen/Core>

#include "core/rigid3.h"

namespace parkade {

/// Where a site's origin lies on WGS84; x east, y north, z up there.
struct SiteDatum {
  double latitude_deg = 0, longitude_deg = 0;
  double altitude = 0;  ///< [m] above the ellipsoid
  bool is_altitude_known =
      true;  ///< false: nobody said how high the site lies, and `altitude` is 0
};

/// How sure it is where a site lies on Earth.
struct SitePlacement {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< [m] in site
  Eigen::Matrix4d covariance =
      Eigen::Matrix4d::Zero();  ///< of [yaw (rad), x, y, z (m) of the center]

  double YawSigma() const;  ///< [rad]
  /// [m] of x, y and z of a point in site: the yaw's error grows with its distance from the center.
  Eigen::Vector3d PositionSigma(const Eigen::Vector3d& point_in_site) const;
};

/// WGS84 position (degrees, ellipsoidal height in m) in the local tangent plane
/// (east, north, up) [m] at `datum`. C. Karney's GeographicLib::LocalCartesian.
Eigen::Vector3d SiteFromGeodetic(const SiteDatum& datum, double latitude_deg, double longitude_deg,
                                 double altitude);

struct Geodetic {
  double latitude_deg = 0, longitude_deg = 0, altitude = 0;
};

Geodetic GeodeticFromSite(const SiteDatum& datum, const Eigen::Vector3d& point_in_site);

/// ECEF (EPSG:4978) from the tangent plane at `datum`.
Rigid3 EarthFromSite(const SiteDatum& datum);

}  // namespace parkade
