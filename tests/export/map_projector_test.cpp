#include "export/map_projector.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

namespace parkade {
namespace {

TEST(MapProjectors, SayWhereOnEarthTheOriginIs) {
  EXPECT_EQ(YAML::Load(MapProjector({}).EncodeInfo())["projector_type"].as<std::string>(), "Local");

  const std::string info = MapProjector(SiteDatum{48.1372, 11.5756, 520.25}).EncodeInfo();
  const YAML::Node yaml = YAML::Load(info);
  EXPECT_EQ(yaml["projector_type"].as<std::string>(), "LocalCartesian");
  EXPECT_EQ(yaml["vertical_datum"].as<std::string>(), "WGS84");
  EXPECT_DOUBLE_EQ(yaml["map_origin"]["latitude"].as<double>(), 48.1372);
  EXPECT_DOUBLE_EQ(yaml["map_origin"]["longitude"].as<double>(), 11.5756);
  EXPECT_EQ(yaml["map_origin"]["altitude"].as<double>(), 0);
  EXPECT_NE(info.find("520.2500 m above"), std::string::npos);
}

TEST(MapProjectors, AreUndoneByAutowaresProjection) {
  const Eigen::Vector3d point(150, -80, 3.25);
  const Geodetic on_earth = MapProjector(SiteDatum{48.1372, 11.5756, 520.25}).Unproject(point);
  const Eigen::Vector3d back = SiteFromGeodetic({48.1372, 11.5756, 0}, on_earth.latitude_deg,
                                                on_earth.longitude_deg, on_earth.altitude);
  EXPECT_LT((back - point).norm(), 1e-6);

  EXPECT_EQ(MapProjector({}).Unproject(point).altitude, 3.25);
}

}  // namespace
}  // namespace parkade
