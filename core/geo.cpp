#include "core/geo.h"

#include <GeographicLib/Geocentric.hpp>
#include <GeographicLib/LocalCartesian.hpp>
#include <cmath>
#include <vector>

namespace parkade {
namespace {

GeographicLib::LocalCartesian TangentPlane(const SiteDatum& datum) {
  return {datum.latitude_deg, datum.longitude_deg, datum.altitude};
}

}  // namespace

double SitePlacement::YawSigma() const { return std::sqrt(covariance(0, 0)); }

Eigen::Vector3d SitePlacement::PositionSigma(const Eigen::Vector3d& point_in_site) const {
  const Eigen::Vector3d arm = point_in_site - center;
  // z is moved apart: its variance may be infinite, which a product with zero would spoil.
  Eigen::Matrix<double, 2, 3> moved_by;  // [yaw, x, y]
  moved_by << -arm.y(), 1, 0, arm.x(), 0, 1;
  const Eigen::Matrix2d horizontal =
      moved_by * covariance.topLeftCorner<3, 3>() * moved_by.transpose();
  return {std::sqrt(horizontal(0, 0)), std::sqrt(horizontal(1, 1)), std::sqrt(covariance(3, 3))};
}

Eigen::Vector3d SiteFromGeodetic(const SiteDatum& datum, double latitude_deg, double longitude_deg,
                                 double altitude) {
  Eigen::Vector3d enu;
  TangentPlane(datum).Forward(latitude_deg, longitude_deg, altitude, enu.x(), enu.y(), enu.z());
  return enu;
}

Geodetic GeodeticFromSite(const SiteDatum& datum, const Eigen::Vector3d& point_in_site) {
  Geodetic geodetic;
  TangentPlane(datum).Reverse(point_in_site.x(), point_in_site.y(), point_in_site.z(),
                              geodetic.latitude_deg, geodetic.longitude_deg, geodetic.altitude);
  return geodetic;
}

Rigid3 EarthFromSite(const SiteDatum& datum) {
  double x = 0, y = 0, z = 0;
  std::vector<double> rotation(9);  // row-major, columns are east, north, up in ECEF
  GeographicLib::Geocentric::WGS84().Forward(datum.latitude_deg, datum.longitude_deg,
                                             datum.altitude, x, y, z, rotation);
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> earth_from_enu(
      rotation.data());
  return {Eigen::Quaterniond(Eigen::Matrix3d(earth_from_enu)).normalized(),
          Eigen::Vector3d(x, y, z)};
}

}  // namespace parkade
