#include "tests/simulator/sensors/gnss_sensor.h"

#include <gtest/gtest.h>

#include "tests/simulator/common/drive_clock.h"
#include "tests/simulator/drives/plan_drive.h"
#include "tests/simulator/layouts/plan_place.h"
#include "tests/simulator/vehicle/simulated_rig.h"

namespace parkade::simulator {
namespace {

/// Along x at 3 m/s, turning a little.
Motion Rolling(double duration) {
  return Motion([](double t) { return PoseVector(PoseVector(3 * t, 0, 0, 0.05 * t, 0, 0)); },
                duration, 0.2);
}

/// The error of a fix against the antenna's true position.
Eigen::Vector3d ErrorOf(const GnssFix& fix, const Motion& motion, const Rig& rig,
                        std::uint64_t seed) {
  const Eigen::Vector3d antenna =
      motion.WorldFromBody(fix.time - DriveEpoch(seed)) * *rig.vehicle->antenna_in_body;
  return SiteFromGeodetic(SimulatedDatum(), fix.latitude_deg, fix.longitude_deg, fix.altitude) -
         antenna;
}

TEST(SimulateGnss, ErrorsHaveTheSizeThatTheFixesState) {
  const Rig rig = MakeSimulatedRig({}, 1);
  for (const char* kind : {"standard", "rtk"}) {
    SensorOptions options;
    options.gnss = kind;
    options.gnss_multipath = 0;
    double nees = 0;
    size_t count = 0;
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
      const Motion motion = Rolling(120);
      for (const GnssFix& fix : SimulateGnss(motion, rig, SimulatedDatum(), options, seed)) {
        nees += ErrorOf(fix, motion, rig, seed).cwiseQuotient(fix.sigma_enu).squaredNorm();
        ++count;
      }
    }
    // About 200 independent times of three axes: 4 sigma are 0.7.
    EXPECT_NEAR(nees / static_cast<double>(count), 3, 0.7) << kind;
  }
}

TEST(SimulateGnss, StandardErrorsAreSlowAndRtkErrorsAreSmall) {
  const Rig rig = MakeSimulatedRig({}, 1);
  const Motion motion = Rolling(600);
  SensorOptions options;
  options.gnss_multipath = 0;
  double step_squares = 0, squares = 0;
  const auto fixes = SimulateGnss(motion, rig, SimulatedDatum(), options, 4);
  for (size_t i = 1; i < fixes.size(); ++i) {
    const double before = ErrorOf(fixes[i - 1], motion, rig, 4).x(),
                 now = ErrorOf(fixes[i], motion, rig, 4).x();
    step_squares += (now - before) * (now - before);
    squares += now * now;
  }
  EXPECT_LT(step_squares, 0.4 * squares);  // 2 were without memory

  options.gnss = "rtk";
  for (const GnssFix& fix : SimulateGnss(motion, rig, SimulatedDatum(), options, 4))
    EXPECT_LT(ErrorOf(fix, motion, rig, 4).norm(), 0.25);
}

TEST(SimulateGnss, AMultipathJumpIsInTheFixesButNotInTheirSigma) {
  const Rig rig = MakeSimulatedRig({}, 1);
  const Motion motion = Rolling(300);
  SensorOptions options, without;
  without.gnss_multipath = 0;
  const auto jumps = PlanMultipath(300, options, 7);
  ASSERT_FALSE(jumps.empty());
  const auto with = SimulateGnss(motion, rig, SimulatedDatum(), options, 7),
             plain = SimulateGnss(motion, rig, SimulatedDatum(), without, 7);

  ASSERT_EQ(with.size(), plain.size());
  for (size_t i = 0; i < with.size(); ++i) {
    const double time = with[i].time - DriveEpoch(7);
    Eigen::Vector3d expected = Eigen::Vector3d::Zero();
    for (const MultipathJump& jump : jumps)
      if (jump.begin <= time && time < jump.end) expected = jump.offset;
    EXPECT_LT(
        (ErrorOf(with[i], motion, rig, 7) - ErrorOf(plain[i], motion, rig, 7) - expected).norm(),
        1e-5);
    EXPECT_EQ(with[i].sigma_enu, plain[i].sigma_enu);
  }
}

TEST(SimulateGnss, UnderARoofThereIsNoFixAndBesideItAWorseOne) {
  const Rig rig = MakeSimulatedRig({}, 1);
  const Motion motion = Rolling(60);
  const auto is_covered = [](const Eigen::Vector3d& point) {
    return point.x() > 60 && point.x() < 90;
  };
  double sigma_far = 0, sigma_near = 0, first_after = 1e9;
  for (const GnssFix& fix : SimulateGnss(motion, rig, SimulatedDatum(), {}, 3, is_covered)) {
    const Eigen::Vector3d antenna =
        motion.WorldFromBody(fix.time - DriveEpoch(3)) * *rig.vehicle->antenna_in_body;
    EXPECT_FALSE(is_covered(antenna));
    if (antenna.x() < 30) sigma_far = fix.sigma_enu.x();
    if (antenna.x() < 60) sigma_near = fix.sigma_enu.x();
    if (antenna.x() > 90) first_after = std::min(first_after, fix.time - DriveEpoch(3));
  }

  EXPECT_GT(sigma_near, 2.5 * sigma_far);
  EXPECT_NEAR(first_after, 30 + 3, 0.5);  // the sky is seen again at 30 s
}

TEST(SimulateGnss, ThereAreFixesBeforeTheGarageAndNoneWithin) {
  const Place garage = PlanPlace("garage", {.seed = 2});
  const DrivePlan plan = PlanDrive(garage, {.length = 150}, 0, 2);
  const Rig rig = MakeSimulatedRig({}, 2);
  size_t num_outside = 0;
  for (const GnssFix& fix :
       SimulateGnss(plan.motion, rig, SimulatedDatum(), {}, 2, garage.is_covered)) {
    const Rigid3 world_from_body = plan.motion.WorldFromBody(fix.time - DriveEpoch(2));
    EXPECT_FALSE(garage.is_covered(world_from_body * *rig.vehicle->antenna_in_body));
    ++num_outside;
  }

  EXPECT_GT(num_outside, 5u);
  EXPECT_LT(num_outside, 0.5 * 5 * plan.motion.Duration());
}

TEST(SimulateGnss, NoneGivesNone) {
  SensorOptions options;
  options.gnss = "none";
  EXPECT_TRUE(
      SimulateGnss(Rolling(5), MakeSimulatedRig({}, 1), SimulatedDatum(), options, 1).empty());
}

}  // namespace
}  // namespace parkade::simulator
