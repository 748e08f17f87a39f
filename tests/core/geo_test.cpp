#include "core/geo.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

const SiteDatum kDatum{48.1372, 11.5756, 520};

// WGS84 by its closed formula, as a second implementation.
Eigen::Vector3d EarthFromGeodetic(double latitude_deg, double longitude_deg, double altitude) {
  constexpr double kA = 6378137, kF = 1 / 298.257223563, kE2 = kF * (2 - kF);
  const double latitude = latitude_deg * M_PI / 180, longitude = longitude_deg * M_PI / 180;
  const double n = kA / std::sqrt(1 - kE2 * std::pow(std::sin(latitude), 2));
  return {(n + altitude) * std::cos(latitude) * std::cos(longitude),
          (n + altitude) * std::cos(latitude) * std::sin(longitude),
          (n * (1 - kE2) + altitude) * std::sin(latitude)};
}

TEST(Geo, SiteIsEastNorthUpAtTheDatum) {
  const Eigen::Vector3d north =
      SiteFromGeodetic(kDatum, kDatum.latitude_deg + 1e-3, kDatum.longitude_deg, 520);
  const Eigen::Vector3d east =
      SiteFromGeodetic(kDatum, kDatum.latitude_deg, kDatum.longitude_deg + 1e-3, 520);
  const Eigen::Vector3d up =
      SiteFromGeodetic(kDatum, kDatum.latitude_deg, kDatum.longitude_deg, 530);

  EXPECT_LT(SiteFromGeodetic(kDatum, kDatum.latitude_deg, kDatum.longitude_deg, 520).norm(), 1e-8);
  EXPECT_NEAR(north.y(), 111.2, 0.1);
  EXPECT_NEAR(north.x(), 0, 1e-6);
  EXPECT_NEAR(east.x(), 74.4, 0.1);
  EXPECT_LT((up - Eigen::Vector3d(0, 0, 10)).norm(), 1e-8);
}

TEST(Geo, GeodeticAndSiteAreInversesOverKilometers) {
  const Eigen::Vector3d point(3210.5, -1834.25, 17);
  const Geodetic geodetic = GeodeticFromSite(kDatum, point);

  EXPECT_LT(
      (SiteFromGeodetic(kDatum, geodetic.latitude_deg, geodetic.longitude_deg, geodetic.altitude) -
       point)
          .norm(),
      1e-7);
}

TEST(Geo, EarthFromSiteAgreesWithTheClosedFormula) {
  const Rigid3 earth_from_site = EarthFromSite(kDatum);
  const Eigen::Vector3d point(150, -80, 3);
  const Geodetic geodetic = GeodeticFromSite(kDatum, point);

  const Eigen::Vector3d expected =
      EarthFromGeodetic(geodetic.latitude_deg, geodetic.longitude_deg, geodetic.altitude);
  EXPECT_LT((earth_from_site * point - expected).norm(), 1e-6);
  EXPECT_LT((earth_from_site.translation - EarthFromGeodetic(48.1372, 11.5756, 520)).norm(), 1e-6);
}

}  // namespace
}  // namespace parkade
