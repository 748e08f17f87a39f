#include "export/trajectory_files.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/export/example_map.h"
#include "tests/support/geoid_folder.h"

namespace parkade {
namespace {

SiteDrive Drive() { return MakeMapWithoutGround().drives[0]; }

/// The truth of the example's drives at a time: a circle of 8 m, once around in 30 s.
Eigen::Vector3d TruePosition(const SiteDrive& drive, Timestamp time) {
  const double angle = 2 * M_PI * (time - drive.odometry.span().begin) / 30;
  return {8 * std::cos(angle), 8 * std::sin(angle), 0.08 * std::sin(angle)};
}

TEST(FinalTrajectory, CoversTheWholeDriveWithoutGaps) {
  const SiteDrive drive = Drive();
  const std::vector<TimedPose> poses = SampleFinalTrajectory(drive);

  EXPECT_EQ(poses.front().time, drive.odometry.span().begin);  // the final states begin 0.5 s later
  EXPECT_EQ(poses.back().time, drive.odometry.span().end);
  for (size_t i = 1; i < poses.size(); ++i) {
    EXPECT_GT(poses[i].time - poses[i - 1].time, 0);
    EXPECT_LE(poses[i].time - poses[i - 1].time, 0.05 + 1e-9);
  }
}

TEST(FinalTrajectory, IsOfTheImuAndFollowsTheOdometryBetweenFinalStates) {
  const SiteDrive drive = Drive();
  const Rigid3 imu_from_body = drive.rig.body_from_imu.Inverse();
  const std::vector<TimedPose> poses = SampleFinalTrajectory(drive);
  ASSERT_GT(poses.size(), 20u);
  for (const TimedPose& pose : poses) {
    const Rigid3 site_from_body = pose.world_from_frame * imu_from_body;
    // Between the 4 Hz states a chord would be 13 mm off the circle. Beyond the last states the
    // drift goes on.
    const bool is_inside = drive.site_from_body_trajectory.span().Contains(pose.time);
    EXPECT_LT((site_from_body.translation - TruePosition(drive, pose.time)).norm(),
              is_inside ? 1e-3 : 0.03);
  }
}

TEST(FinalTrajectory, WithoutOdometryIsInterpolatedFromItsOwnStates) {
  SiteDrive drive = Drive();
  drive.odometry = {};
  const std::vector<TimedPose> poses = SampleFinalTrajectory(drive);

  EXPECT_EQ(poses.front().time, drive.site_from_body_trajectory.span().begin);
  EXPECT_EQ(poses.back().time, drive.site_from_body_trajectory.span().end);
  EXPECT_GE(static_cast<double>(poses.size()),
            20 * drive.site_from_body_trajectory.span().Seconds());
  EXPECT_TRUE(SampleFinalTrajectory({}).empty());
}

TEST(Odometry, StartsWhereTheFinalTrajectoryDoesAndKeepsItsDrift) {
  SiteDrive drive = Drive();
  const Rigid3 odom_from_site{Eigen::Quaterniond(Eigen::AngleAxisd(1, Eigen::Vector3d::UnitZ())),
                              {100, -50, 3}};
  drive.odometry = drive.odometry.Transformed(odom_from_site);

  const std::vector<TimedPose> odometry = SampleOdometry(drive);
  const std::vector<TimedPose> final_poses = SampleFinalTrajectory(drive);

  ASSERT_EQ(odometry.size(), drive.odometry.states().size());
  EXPECT_LT(
      (odometry.front().world_from_frame.Matrix() - final_poses.front().world_from_frame.Matrix())
          .norm(),
      1e-9);
  // Distances within the odometry do not change.
  const Rigid3& last = drive.odometry.states().back().world_from_body;
  const Rigid3& first = drive.odometry.states().front().world_from_body;
  const Rigid3 expected =
      (first * drive.rig.body_from_imu).Inverse() * (last * drive.rig.body_from_imu);
  const Rigid3 actual =
      odometry.front().world_from_frame.Inverse() * odometry.back().world_from_frame;
  EXPECT_LT((actual.Matrix() - expected.Matrix()).norm(), 1e-9);
  EXPECT_GT((odometry.back().world_from_frame.translation -
             final_poses.back().world_from_frame.translation)
                .norm(),
            0.1);
}

TEST(TrajectoryGeoJson, IsTheDriveOnTheGlobe) {
  const SiteDatum datum{48.1372, 11.5756, 520};
  const SiteDrive drive = Drive();
  const auto json = nlohmann::json::parse(EncodeTrajectoryGeoJson(drive, datum));

  const auto& feature = json.at("features").at(0);
  EXPECT_EQ(feature.at("properties").at("drive"), "monday");
  const auto& line = feature.at("geometry").at("coordinates");
  const auto& times = feature.at("properties").at("times_s");
  ASSERT_EQ(line.size(), times.size());
  ASSERT_GT(line.size(), 300U);  // 50 m, a point every 0.1 m
  for (const size_t i : {size_t{0}, line.size() / 2, line.size() - 1}) {
    const Eigen::Vector3d in_site = SiteFromGeodetic(datum, line[i][1], line[i][0], line[i][2]);
    EXPECT_LT((in_site - TruePosition(drive, ParseSeconds(times[i]))).norm(), 0.03);
  }
}

TEST(TrajectoryKml, HoldsTheSamePositions) {
  const SiteDatum datum{48.1372, 11.5756, 520};
  SiteDrive drive = Drive();
  drive.name = "a<b>&c";
  const std::string kml = EncodeTrajectoryKml(drive, datum);

  EXPECT_NE(kml.find("<name>a&lt;b&gt;&amp;c</name>"), std::string::npos);
  const auto json = nlohmann::json::parse(EncodeTrajectoryGeoJson(drive, datum));
  const auto num_points = json.at("features").at(0).at("geometry").at("coordinates").size();
  const size_t begin = kml.find("<coordinates>\n") + 14, end = kml.find("</coordinates>");
  EXPECT_EQ(static_cast<size_t>(std::count(kml.begin() + static_cast<long>(begin),
                                           kml.begin() + static_cast<long>(end), '\n')),
            num_points);
}

/// The third of the first coordinates in a KML.
double FirstHeight(const std::string& kml) {
  const size_t begin = kml.find("<coordinates>\n") + 14, end = kml.find('\n', begin);
  return std::stod(kml.substr(kml.rfind(',', end) + 1));
}

TEST_F(GeoidFolder, KmlCountsHeightsFromTheSeaAndGeoJsonFromTheEllipsoid) {
  const SiteDatum datum{48.1372, 11.5756, 520};
  WriteGrid("egm96-15");
  const std::optional<Geoid> geoid = Geoid::Find();
  ASSERT_TRUE(geoid);
  const std::string above_sea = EncodeTrajectoryKml(Drive(), datum, geoid);
  const std::string above_ellipsoid = EncodeTrajectoryKml(Drive(), datum);

  EXPECT_NEAR(FirstHeight(above_ellipsoid) - FirstHeight(above_sea),
              UndulationAt(datum.latitude_deg), 0.3);
  EXPECT_NE(above_sea.find("above mean sea level (egm96-15)"), std::string::npos);
  EXPECT_NE(above_ellipsoid.find("no geoid model"), std::string::npos);
  const auto json = nlohmann::json::parse(EncodeTrajectoryGeoJson(Drive(), datum));
  EXPECT_NEAR(json.at("features").at(0).at("geometry").at("coordinates").at(0).at(2),
              FirstHeight(above_ellipsoid), 1e-6);
}

TEST(TrajectoryKml, InventsNoHeights) {
  const SiteDatum datum{48.1372, 11.5756, 0, false};
  const std::string kml = EncodeTrajectoryKml(Drive(), datum);

  EXPECT_NE(kml.find("<altitudeMode>clampToGround</altitudeMode>"), std::string::npos);
  const size_t begin = kml.find("<coordinates>\n") + 14;
  const std::string first = kml.substr(begin, kml.find('\n', begin) - begin);
  EXPECT_EQ(std::count(first.begin(), first.end(), ','), 1) << first;
  const auto json = nlohmann::json::parse(EncodeTrajectoryGeoJson(Drive(), datum));
  EXPECT_EQ(json.at("features").at(0).at("geometry").at("coordinates").at(0).size(), 2U);
}

TEST(TrajectoryGeoJson, ADriveWithoutPosesHasNoGeometry) {
  const auto json = nlohmann::json::parse(EncodeTrajectoryGeoJson({}, {}));
  EXPECT_TRUE(json.at("features").at(0).at("geometry").is_null());
}

}  // namespace
}  // namespace parkade
