#include "tests/simulator/motion/motion.h"

#include <gtest/gtest.h>

#include "tests/simulator/drives/plan_drive.h"
#include "tests/simulator/layouts/plan_place.h"
#include "tests/simulator/sensors/imu_integration.h"
#include "tests/simulator/vehicle/simulated_rig.h"

namespace parkade::simulator {
namespace {

PoseVector Wavy(double t) {
  PoseVector pose;
  pose << 3 * std::sin(0.7 * t), 2 * std::cos(0.9 * t), 0.05 * std::sin(2 * t), 0.8 * t,
      0.03 * std::sin(3 * t), 0.05 * std::cos(2.5 * t);
  return pose;
}

TEST(Motion, FollowsTheFunctionItIsMadeFrom) {
  const Motion motion(Wavy, 5);

  for (double t = 0; t <= 5; t += 0.137)
    EXPECT_LT((motion.WorldFromBody(t).translation - Wavy(t).head<3>()).norm(), 1e-6) << t;
}

TEST(Motion, DerivativesMatchFiniteDifferences) {
  const Motion motion(Wavy, 5);
  const double h = 1e-4;

  for (double t = 0.1; t < 4.9; t += 0.0931) {
    const MotionState before = motion.At(t - h), now = motion.At(t), after = motion.At(t + h);
    const Eigen::Vector3d velocity =
        (after.world_from_body.translation - before.world_from_body.translation) / (2 * h);
    const Eigen::Vector3d acceleration =
        (after.velocity_in_world - before.velocity_in_world) / (2 * h);
    const Eigen::Vector3d turn =
        LogSo3(before.world_from_body.rotation.conjugate() * after.world_from_body.rotation) /
        (2 * h);
    const Eigen::Vector3d angular_acceleration =
        (after.angular_velocity_in_body - before.angular_velocity_in_body) / (2 * h);
    EXPECT_LT((velocity - now.velocity_in_world).norm(), 1e-6);
    EXPECT_LT((acceleration - now.acceleration_in_world).norm(), 1e-5);
    EXPECT_LT((turn - now.angular_velocity_in_body).norm(), 1e-6);
    EXPECT_LT((angular_acceleration - now.angular_acceleration_in_body).norm(), 1e-5);
  }
}

/// Each scene, driven from end to end: forward, and backwards into a slot where there is one.
class DrivesInScenes : public testing::TestWithParam<std::string> {
 protected:
  const DrivePlan plan_ =
      PlanDrive(PlanPlace(GetParam(), {.seed = 3}), {.length = 120, .parks = true}, 0, 3);
  const Rigid3 body_from_imu_ = MakeSimulatedRig({}, 3).body_from_imu;
};

TEST_P(DrivesInScenes, AnIdealImuIntegratesToTheTruthWithinMillimetersOverTenSeconds) {
  for (double start = 0; start + 10 < plan_.motion.Duration(); start += 4)
    EXPECT_LT(IntegrationError(plan_.motion, body_from_imu_, start, 10, 1000), 0.002)
        << "from " << start << " s";
}

TEST_P(DrivesInScenes, AHundredSamplesASecondAreEnoughForFiveCentimeters) {
  for (double start = 0; start + 10 < plan_.motion.Duration(); start += 4)
    EXPECT_LT(IntegrationError(plan_.motion, body_from_imu_, start, 10, 100), 0.05)
        << "from " << start << " s";
}

INSTANTIATE_TEST_SUITE_P(Scenes, DrivesInScenes, testing::ValuesIn(SceneNames()));

}  // namespace
}  // namespace parkade::simulator
