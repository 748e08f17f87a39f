#include "slam/georeference/align_to_gnss.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/slam/worlds/real_clip.h"

namespace parkade {
namespace {

const SiteDatum kDatum{48.137, 11.575, 520};
const Eigen::Vector3d kAntenna(1.2, 0.1, 1.5);
const Rigid3 kSiteFromOdom{ExpSo3({0, 0, 2.2}), {40, -25, 1.5}};

/// A drive around a block, `length` [m] per side, at 5 m/s.
Trajectory DriveAround(double length) {
  std::vector<TrajectoryState> states;
  for (int i = 0; i < 400; ++i) {
    const double angle = 2 * M_PI * i / 400;
    TrajectoryState state;
    state.time = Timestamp{100'000'000LL * i};
    state.world_from_body = {
        ExpSo3({0, 0, angle + M_PI / 2}),
        {0.5 * length * std::cos(angle), 0.5 * length * std::sin(angle), 0.2 * std::sin(angle)}};
    states.push_back(state);
  }
  return Trajectory(states);
}

std::vector<GnssFix> FixesOf(const Trajectory& trajectory, double sigma, std::uint32_t seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, sigma);
  std::vector<GnssFix> fixes;
  for (const TrajectoryState& state : trajectory.states()) {
    const Eigen::Vector3d noise(normal(random), normal(random), 2 * normal(random));
    const Eigen::Vector3d in_site = kSiteFromOdom * (state.world_from_body * kAntenna) + noise;
    const Geodetic place = GeodeticFromSite(kDatum, in_site);
    fixes.push_back({state.time,
                     place.latitude_deg,
                     place.longitude_deg,
                     place.altitude,
                     {sigma, sigma, 2 * sigma}});
  }
  return fixes;
}

/// [m] between where the alignment puts a point of the drive and where it is.
double ErrorAt(const GnssAlignment& alignment, const Eigen::Vector3d& point_in_odom) {
  const Eigen::Vector3d found =
      EarthFromSite(alignment.datum) * (alignment.site_from_odom * point_in_odom);
  return (found - EarthFromSite(kDatum) * (kSiteFromOdom * point_in_odom)).norm();
}

TEST(AlignToGnss, ExactFixesGiveTheExactPlaceWithLeverArm) {
  const Trajectory drive = DriveAround(60);

  const auto alignment = AlignToGnss(drive, FixesOf(drive, 1e-6), kAntenna);

  ASSERT_TRUE(alignment);
  // The site's tangent plane at another datum leans by 5 m / 6371 km.
  EXPECT_LT(ErrorAt(*alignment, {30, 0, 0}), 1e-3);
  EXPECT_EQ(alignment->num_inliers, 400);
}

TEST(AlignToGnss, GivenDatumIsKept) {
  const Trajectory drive = DriveAround(60);

  const auto alignment = AlignToGnss(drive, FixesOf(drive, 1e-6), kAntenna, {}, kDatum);

  ASSERT_TRUE(alignment);
  EXPECT_EQ(alignment->datum.latitude_deg, kDatum.latitude_deg);
  EXPECT_LT((alignment->site_from_odom.translation - kSiteFromOdom.translation).norm(), 1e-5);
  EXPECT_LT(alignment->site_from_odom.rotation.angularDistance(kSiteFromOdom.rotation), 1e-6);
}

TEST(AlignToGnss, AThirdOfReflectedFixesDoesNoHarm) {
  const Trajectory drive = DriveAround(60);
  std::vector<GnssFix> fixes = FixesOf(drive, 0.5);
  for (size_t i = 100; i < 233; ++i) fixes[i].latitude_deg += 3e-4;  // 33 m north, all the same way
  fixes[0].latitude_deg = fixes[0].longitude_deg = 0;  // a receiver that has just started

  const auto alignment = AlignToGnss(drive, fixes, kAntenna);

  ASSERT_TRUE(alignment);
  EXPECT_LT(ErrorAt(*alignment, {0, 30, 0}), 0.3);
  EXPECT_NEAR(alignment->num_inliers, 266, 15);
  EXPECT_NEAR(alignment->horizontal_rmse, 0.7, 0.1) << "0.5 m east and 0.5 m north";
  EXPECT_GT(alignment->cep95, 20) << "the reflected ones are in the statistics";
}

TEST(AlignToGnss, ReportedYawSigmaIsHonest) {
  const Trajectory drive = DriveAround(60);
  GnssAlignOptions options;
  options.correlation_time = 0;  // the noise here is white
  options.odometry_drift = 0;
  double squared = 0, claimed = 0;
  constexpr int kTrials = 60;
  for (std::uint32_t seed = 1; seed <= kTrials; ++seed) {
    const auto alignment = AlignToGnss(drive, FixesOf(drive, 1.0, seed), kAntenna, options);
    ASSERT_TRUE(alignment);
    const double error =
        LogSo3(alignment->site_from_odom.rotation * kSiteFromOdom.rotation.conjugate()).z();
    squared += error * error / kTrials;
    claimed += alignment->covariance(0, 0) / kTrials;
  }

  EXPECT_GT(claimed / squared, 0.6);
  EXPECT_LT(claimed / squared, 2.5) << "robust weights below 1 cost some information";
}

TEST(AlignToGnss, StandstillAndTooShortADriveHaveNoHeading) {
  std::vector<TrajectoryState> states;
  for (int i = 0; i < 400; ++i) {
    TrajectoryState state;
    state.time = Timestamp{100'000'000LL * i};
    states.push_back(state);
  }
  const Trajectory standing(states), crawling = DriveAround(5);

  EXPECT_FALSE(AlignToGnss(standing, FixesOf(standing, 1.0), kAntenna));
  EXPECT_FALSE(AlignToGnss(crawling, FixesOf(crawling, 2.0), kAntenna));
}

TEST(AlignToGnss, BadFixesAreLeftOutAndNoneLeftMeansNoAnswer) {
  const Trajectory drive = DriveAround(60);
  std::vector<GnssFix> fixes = FixesOf(drive, 0.1);
  fixes[3].latitude_deg = std::nan("");
  fixes[4].sigma_enu.setConstant(500);
  fixes[5].time.ns -= 1'000'000'000'000;

  const auto alignment = AlignToGnss(drive, fixes, kAntenna);

  ASSERT_TRUE(alignment);
  EXPECT_EQ(alignment->num_fixes, 397);
  EXPECT_FALSE(AlignToGnss(drive, {}, kAntenna));
  EXPECT_FALSE(AlignToGnss(Trajectory(), fixes, kAntenna));
}

/// A car on a road, 60 s, from shared/data: poses of a survey-grade system and
/// the fixes of a u-blox receiver.
TEST(AlignToGnss, ARealReceiverPlacesARealDrive) {
  const auto folder = FindSharedData("comma2k19_drive");
  if (!folder) GTEST_SKIP() << "no comma2k19_drive";
  const auto poses = ReadCsv(*folder / "pose_ecef.csv");
  const auto number = [](const std::vector<std::string>& row, size_t i) {
    return std::stod(row.at(i));
  };
  std::vector<GnssFix> fixes;
  for (const auto& row : ReadCsv(*folder / "gnss_ublox.csv"))
    fixes.push_back(
        {ParseSeconds(row.at(0)), number(row, 1), number(row, 2), number(row, 5), {2, 2, 4}});
  const SiteDatum datum{fixes[0].latitude_deg, fixes[0].longitude_deg, fixes[0].altitude};
  const Rigid3 odom_from_site{ExpSo3({0, 0, -1.3}), {70, -30, 4}};
  std::vector<TrajectoryState> states;
  for (const auto& row : poses) {
    const Rigid3 earth_from_device{{number(row, 4), number(row, 5), number(row, 6), number(row, 7)},
                                   {number(row, 1), number(row, 2), number(row, 3)}};
    TrajectoryState state;
    state.time = ParseSeconds(row.at(0));
    state.world_from_body = odom_from_site * EarthFromSite(datum).Inverse() * earth_from_device;
    states.push_back(state);
  }
  const Trajectory drive(states);

  const auto alignment = AlignToGnss(drive, fixes, Eigen::Vector3d::Zero(), {}, datum);

  ASSERT_TRUE(alignment);
  const Rigid3 error = alignment->site_from_odom * odom_from_site;
  EXPECT_LT(std::abs(LogSo3(error.rotation).z()), std::max(0.01, 3 * alignment->YawSigma()));
  const Eigen::Vector3d middle =
      odom_from_site.Inverse() *
      drive.states()[drive.states().size() / 2].world_from_body.translation;
  EXPECT_LT((error * middle - middle).head<2>().norm(), 4) << "[m] a receiver without corrections";
  EXPECT_GT(alignment->num_inliers, alignment->num_fixes * 9 / 10);
  EXPECT_LT(alignment->cep50, 2);
  EXPECT_GT(alignment->extent, 100);
}

TEST(AlignToGnss, DrivesPlaceASiteTogetherMoreSurelyThanEach) {
  GnssAlignment west, east;
  west.center_in_odom = {-50, 0, 0};
  east.center_in_odom = {50, 0, 0};
  for (GnssAlignment* drive : {&west, &east}) drive->covariance.diagonal() << 1e-2, 1, 1, 4;

  EXPECT_TRUE(PlacementBy({east}).covariance.isApprox(east.covariance, 1e-9));
  EXPECT_TRUE(PlacementBy({east}).center.isApprox(east.center_in_odom, 1e-9));
  const SitePlacement both = PlacementBy({west, east});
  EXPECT_LT(both.center.norm(), 1e-9);
  EXPECT_NEAR(both.covariance(1, 1), 0.5, 1e-9);
  EXPECT_NEAR(both.covariance(3, 3), 2, 1e-9);
  // The line between them has a heading of its own: one meter each at 50 m of arm.
  EXPECT_NEAR(1 / both.covariance(0, 0), 2 / 1e-2 + 2 * 50.0 * 50.0, 1e-6);
}

}  // namespace
}  // namespace parkade
