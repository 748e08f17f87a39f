#include "server/pipeline/drive_diagnostics.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/api_description.h"

namespace parkade {
namespace {

using nlohmann::json;

/// Two seconds backwards along x at 2 m/s, from 100 s on.
SiteDrive Backwards() {
  SiteDrive drive;
  drive.name = "lot";
  RigCamera& camera = drive.rig.cameras.emplace_back();
  camera.name = "cam0";
  camera.model = CameraModel(PinholeProjection{30, 30, 32, 24}, 64, 48);
  camera.body_from_camera.translation = {3, 0, 1};
  std::vector<TrajectoryState> states;
  for (int i = 0; i <= 40; ++i) {
    TrajectoryState& state = states.emplace_back();
    state.time = TimestampFromSeconds(100 + 0.05 * i);
    state.world_from_body.translation = {-0.1 * i, 0, 0};
    state.velocity_in_world = {-2, 0, 0};
    state.covariance.diagonal() << 1e-6, 1e-6, 4e-6, 9e-4, 16e-4, 4e-4;
  }
  drive.site_from_body_trajectory = Trajectory(std::move(states));
  return drive;
}

json SeriesNamed(const json& all, const std::string& name) {
  for (const json& series : all.at("series"))
    if (series.at("name") == name) return series;
  return nullptr;
}

/// With what the service adds.
json AsAnswered(json all) {
  all.update({{"drive", "0123"}, {"site", "lot"}, {"version", 1}});
  if (all.contains("series"))
    for (json& series : all.at("series")) series["count"] = 1;
  return all;
}

TEST(Diagnostics, SpeedAndSigmasAreThoseOfTheTrajectory) {
  const json all = json::parse(EncodeDiagnostics(Backwards(), {}, {}, std::nullopt));

  EXPECT_EQ(all.at("start"), "100.000000000");
  EXPECT_EQ(all.at("end"), 2.0);
  const json speed = SeriesNamed(all, "speed");
  EXPECT_EQ(speed.at("unit"), "m/s");
  ASSERT_EQ(speed.at("values").size(), 41u);
  EXPECT_EQ(speed.at("values").at(7), -2.0) << "backwards is negative";
  EXPECT_EQ(speed.at("times").at(7), 0.35);
  EXPECT_EQ(SeriesNamed(all, "sigma_position").at("values").at(0), 0.05);
  EXPECT_EQ(SeriesNamed(all, "sigma_height").at("values").at(0), 0.02);
  EXPECT_EQ(SeriesNamed(all, "sigma_yaw").at("values").at(0), 0.002);
}

TEST(Diagnostics, WhatTheDriveHasNotIsLeftOut) {
  const json all = json::parse(EncodeDiagnostics(Backwards(), {}, {}, std::nullopt));

  for (const char* name : {"inliers", "residual", "wheel_slip", "gnss_sigma", "gnss_error"})
    EXPECT_TRUE(SeriesNamed(all, name).is_null()) << name;
}

TEST(Diagnostics, ImagesWithoutInliersHaveNoResidual) {
  DriveDiagnostics diagnostics;
  diagnostics.residuals.images = {{TimestampFromSeconds(100.5), 0, 30, 0.001},
                                  {TimestampFromSeconds(100.6), 0, 0, 0}};
  diagnostics.residuals.wheels = {{TimestampFromSeconds(101), 0.25}};
  const json all = json::parse(EncodeDiagnostics(Backwards(), diagnostics, {}, std::nullopt));

  EXPECT_EQ(SeriesNamed(all, "inliers").at("camera"), "cam0");
  EXPECT_EQ(SeriesNamed(all, "inliers").at("values"), (json{30.0, 0.0}));
  EXPECT_EQ(SeriesNamed(all, "residual").at("values"), json{0.001});
  EXPECT_EQ(SeriesNamed(all, "wheel_slip").at("times"), json{1.0});
}

TEST(Diagnostics, FixesAreHeldAgainstTheAntenna) {
  const SiteDatum datum{48, 11, 500};
  DriveDiagnostics diagnostics;
  diagnostics.gnss.antenna_in_body = {1, 0, 2};
  // The antenna is at (0, 0, 2) half a second on; this fix is 3 m north of it.
  const Geodetic fix = GeodeticFromSite(datum, {0, 3, 9});
  diagnostics.gnss.fixes = {
      {TimestampFromSeconds(100.5), fix.latitude_deg, fix.longitude_deg, fix.altitude, {1, 2, 5}}};
  const json all = json::parse(EncodeDiagnostics(Backwards(), diagnostics, {}, datum));

  EXPECT_EQ(SeriesNamed(all, "gnss_sigma").at("values").at(0), 2.0);
  EXPECT_NEAR(SeriesNamed(all, "gnss_error").at("values").at(0).get<double>(), 3, 1e-3);
}

TEST(Diagnostics, DegradedIntervalsCountFromTheStart) {
  OdometryReport report;
  report.degraded = {{TimestampFromSeconds(100.5), TimestampFromSeconds(101), "dark"}};
  const json all = json::parse(EncodeDiagnostics(Backwards(), {}, report, std::nullopt));

  EXPECT_EQ(all.at("degraded"), json::parse(R"([{"begin": 0.5, "end": 1.0, "reason": "dark"}])"));
  EXPECT_EQ(MismatchWith("Plots", AsAnswered(all)), "");
}

TEST(Keyframes, HaveTheirPoseInTheSite) {
  const json all = json::parse(EncodeKeyframes(
      Backwards(), {{TimestampFromSeconds(101), 0, {}}, {TimestampFromSeconds(200), 0, {}}}));

  ASSERT_EQ(all.at("keyframes").size(), 1u) << "the other one is outside of the trajectory";
  const json keyframe = all.at("keyframes").at(0);
  EXPECT_EQ(keyframe.at("time"), "101.000000000");
  EXPECT_EQ(keyframe.at("camera"), "cam0");
  EXPECT_EQ(keyframe.at("site_from_body").at("position"), (json{-2.0, 0.0, 0.0}));
  EXPECT_EQ(all.at("cameras").at(0).at("body_from_camera").at("position"), (json{3.0, 0.0, 1.0}));
  json answer = AsAnswered(all);
  answer["count"] = 1;
  EXPECT_EQ(MismatchWith("Keyframes", answer), "");
}

}  // namespace
}  // namespace parkade
