#include "slam/sessions/place_by_gnss.h"

#include <gtest/gtest.h>

#include <random>

namespace parkade {
namespace {

Rigid3 Turned(double yaw, const Eigen::Vector3d& translation) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())), translation};
}

/// A drive of 40 m whose odometry starts anywhere, in a group that lies at `site_from_group`; its
/// GNSS errs by `error` [yaw, x, y, z of the center].
GnssDrive DriveAt(const Rigid3& site_from_group, const Rigid3& group_from_odom,
                  const Eigen::Vector4d& error, const Eigen::Matrix4d& covariance) {
  GnssDrive drive;
  for (int i = 0; i < 20; ++i) {
    drive.in_odom.push_back({2.0 * i, 0.05 * i * i, 0.1 * i});
    drive.in_group.push_back(group_from_odom * drive.in_odom.back());
  }
  drive.alignment.covariance = covariance;
  drive.alignment.center_in_odom = {19, 6, 1};
  const Rigid3 true_pose = site_from_group * group_from_odom;
  const Eigen::Vector3d center = true_pose * drive.alignment.center_in_odom;
  const Eigen::Quaterniond rotation = Turned(error[0], {0, 0, 0}).rotation * true_pose.rotation;
  drive.alignment.site_from_odom = {
      rotation, center + error.tail<3>() - rotation * drive.alignment.center_in_odom};
  return drive;
}

Eigen::Matrix4d Covariance(double yaw_sigma, double sigma) {
  return Eigen::Vector4d(yaw_sigma * yaw_sigma, sigma * sigma, sigma * sigma, 3 * sigma * sigma)
      .asDiagonal();
}

TEST(PlaceByGnss, NoDriveNoPlace) { EXPECT_FALSE(PlaceByGnss({})); }

TEST(PlaceByGnss, OneDriveSaysItAll) {
  const GnssDrive drive = DriveAt(Turned(2, {100, -50, 3}), Turned(0.7, {4, 5, 6}),
                                  {0.02, 1, -2, 3}, Covariance(0.01, 1));
  const Rigid3 expected = drive.alignment.site_from_odom * Turned(0.7, {4, 5, 6}).Inverse();
  const Rigid3 found = *PlaceByGnss(std::vector{drive});
  EXPECT_LT((found.translation - expected.translation).norm(), 1e-9);
  EXPECT_LT(found.rotation.angularDistance(expected.rotation), 1e-9);
}

TEST(PlaceByGnss, ASurerDriveWeighsMore) {
  const Rigid3 truth = Turned(-1, {10, 20, 0});
  const GnssDrive sure = DriveAt(truth, Turned(0, {0, 0, 0}), {0, 0, 0, 0}, Covariance(0.01, 0.1));
  const GnssDrive unsure = DriveAt(truth, Turned(3, {1, 0, 0}), {0, 5, 0, 0}, Covariance(0.01, 1));
  const Rigid3 found = *PlaceByGnss(std::vector{sure, unsure});
  EXPECT_NEAR((found * Eigen::Vector3d(19, 6, 1) - truth * Eigen::Vector3d(19, 6, 1)).norm(),
              5.0 / 101, 0.02);
}

TEST(PlaceByGnss, DrivesFarApartTurnTheSite) {
  const Eigen::Matrix4d covariance = Covariance(1, 0.1);  // no drive knows its heading
  const GnssDrive here = DriveAt({}, Turned(0, {0, 0, 0}), {0, 0, 0, 0}, covariance);
  const GnssDrive there = DriveAt({}, Turned(0, {200, 0, 0}), {0, 0, 2, 0}, covariance);
  const Rigid3 found = *PlaceByGnss(std::vector{here, there});
  EXPECT_NEAR(found.rotation.angularDistance(Turned(0.01, {0, 0, 0}).rotation), 0, 1e-4);
}

TEST(PlaceByGnss, ErrsAsItsDrivesClaim) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  constexpr int kRuns = 200, kDrives = 6;
  double squared = 0;
  for (int run = 0; run < kRuns; ++run) {
    const Rigid3 truth = Turned(normal(random), {10 * normal(random), 0, 0});
    std::vector<GnssDrive> drives;
    std::vector<GnssAlignment> alignments;
    for (int i = 0; i < kDrives; ++i) {
      const Eigen::Vector4d sigmas(0.02, 1.5, 1.5, 2.6);
      const Eigen::Vector4d error(0.02 * normal(random), 1.5 * normal(random), 1.5 * normal(random),
                                  2.6 * normal(random));
      drives.push_back(DriveAt(truth,
                               Turned(normal(random), {5 * normal(random), 5 * normal(random), 0}),
                               error, sigmas.cwiseAbs2().asDiagonal()));
      alignments.push_back(drives.back().alignment);
    }
    const Rigid3 found = *PlaceByGnss(drives);
    const SitePlacement placement = PlacementBy(alignments);
    const Rigid3 site_from_true = found * truth.Inverse();
    Eigen::Vector4d error;
    error << 2 * std::asin(site_from_true.rotation.z() *
                           (site_from_true.rotation.w() < 0 ? -1 : 1)),
        site_from_true * placement.center - placement.center;
    squared += error.dot(placement.covariance.ldlt().solve(error)) / 4;
  }
  EXPECT_GT(squared / kRuns, 0.85);  // 800 degrees of freedom: 0.90 to 1.10 in 95 % of such tests
  EXPECT_LT(squared / kRuns, 1.15);
}

}  // namespace
}  // namespace parkade
