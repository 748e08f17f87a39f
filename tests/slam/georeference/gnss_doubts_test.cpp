#include "slam/georeference/gnss_doubts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "core/geo.h"

namespace parkade {
namespace {

constexpr double kRadian = 57.29577951308232;
const SiteDatum kDatum{48.137, 11.575, 520};

Timestamp At(double seconds) { return Timestamp{1'700'000'000'000'000'000} + seconds; }

Eigen::Vector3d PositionAt(double seconds) { return {2 * seconds, 8 * std::sin(0.2 * seconds), 0}; }

Trajectory Drive() {
  std::vector<TrajectoryState> states;
  for (double t = 0; t <= 20; t += 0.1)
    states.push_back(
        {.time = At(t), .world_from_body = {Eigen::Quaterniond::Identity(), PositionAt(t)}});
  return Trajectory(std::move(states));
}

/// What is said of fixes along the drive, turned into its site, which were altered.
std::string Doubt(const std::function<void(GnssFix&, int)>& alter, double sigma = 0.5) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, sigma);
  const Eigen::Quaterniond site_from_odom = ExpSo3({0, 0, 0.8});
  std::vector<GnssFix> fixes;
  for (int i = 0; i < 100; ++i) {
    const double t = 0.2 * i;
    const Geodetic place = GeodeticFromSite(
        kDatum, site_from_odom * PositionAt(t) + Eigen::Vector3d(noise(random), noise(random), 0));
    GnssFix fix{At(t), place.latitude_deg, place.longitude_deg, place.altitude,
                Eigen::Vector3d::Constant(sigma)};
    alter(fix, i);
    fixes.push_back(fix);
  }
  return DoubtOfFixes(Drive(), fixes, 10);
}

TEST(GnssDoubts, BelieveGoodFixesAndSomeWildOnes) {
  EXPECT_EQ(Doubt([](GnssFix&, int) {}), "");
  EXPECT_EQ(Doubt([](GnssFix&, int) {}, 2), "");
  EXPECT_EQ(Doubt([](GnssFix& fix, int i) {
              if (i % 4 == 0) fix.latitude_deg += 1e-3;
            }),
            "");
}

TEST(GnssDoubts, NameWhatFixesLookLike) {
  const auto swapped = [](GnssFix& fix, int) { std::swap(fix.latitude_deg, fix.longitude_deg); };
  EXPECT_NE(Doubt(swapped).find("changed places"), std::string::npos) << Doubt(swapped);
  const auto radians = [](GnssFix& fix, int) {
    fix.latitude_deg /= kRadian;
    fix.longitude_deg /= kRadian;
  };
  EXPECT_NE(Doubt(radians).find("in radians"), std::string::npos) << Doubt(radians);
  const auto frozen = [](GnssFix& fix, int) {
    fix.latitude_deg = 48.2;
    fix.longitude_deg = 11.6;
  };
  EXPECT_NE(Doubt(frozen).find("stay at one spot while the car drives 46 m"), std::string::npos)
      << Doubt(frozen);
  const auto elsewhere = [](GnssFix& fix, int i) { fix.latitude_deg += 1e-5 * ((i * 37) % 50); };
  EXPECT_NE(Doubt(elsewhere).find("contradict the trajectory, most of them"), std::string::npos)
      << Doubt(elsewhere);
}

TEST(GnssDoubts, AskForADriveThatIsLargeBesideTheNoise) {
  const auto swapped = [](GnssFix& fix, int) { std::swap(fix.latitude_deg, fix.longitude_deg); };
  EXPECT_EQ(Doubt(swapped, 8), "");
}

}  // namespace
}  // namespace parkade
