#include "tests/simulator/drives/plan_drive.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/simulator/layouts/lot_layout.h"
#include "tests/simulator/layouts/plan_place.h"
#include "tests/simulator/vehicle/car_mesh.h"
#include "tests/simulator/vehicle/simulated_rig.h"

namespace parkade::simulator {
namespace {

double SpeedAt(const DrivePlan& plan, double time) {
  return plan.motion.At(time).velocity_in_world.norm();
}

class PlannedDrive : public testing::TestWithParam<int> {
 protected:
  const std::uint64_t seed_ = static_cast<std::uint64_t>(GetParam());
  const LotLayout layout_ = PlanLot(seed_);
  const Place place_ = PlanPlace("lot", {.seed = seed_});
  const DrivePlan plan_ = PlanDrive(place_, 40, seed_);
};

TEST_P(PlannedDrive, StandsAtFirstStopsOnceOnTheWayAndStandsAtTheEnd) {
  int num_stands = 0;
  bool was_standing = false;
  for (double time = 0; time <= 40; time += 0.1) {
    const bool is_standing = SpeedAt(plan_, time) < 0.01;
    num_stands += is_standing && !was_standing;
    was_standing = is_standing;
  }

  EXPECT_LT(SpeedAt(plan_, 1), 1e-3);
  EXPECT_EQ(num_stands, 3);
}

TEST_P(PlannedDrive, ReturnsNearItsStart) {
  const Eigen::Vector3d start = plan_.motion.WorldFromBody(0).translation;
  const Eigen::Vector3d end = plan_.motion.WorldFromBody(40).translation;

  EXPECT_TRUE(plan_.returns_to_start);
  EXPECT_LT((end - start).norm(), 4);
  EXPECT_GT(plan_.length, 70);
}

TEST_P(PlannedDrive, KeepsToTheLimitsOfACar) {
  EXPECT_GE(plan_.min_radius, 5);
  EXPECT_LE(plan_.max_speed, 6.01);
  for (double time = 0; time <= 40; time += 0.05) {
    const MotionState state = plan_.motion.At(time);
    const Eigen::Vector3d in_body =
        state.world_from_body.rotation.conjugate() * state.acceleration_in_world;
    EXPECT_LT(std::hypot(in_body.x(), in_body.y()), 3.5) << time;
    // It rolls where it points to: no sideways velocity beyond what smoothing leaves.
    const Eigen::Vector3d velocity =
        state.world_from_body.rotation.conjugate() * state.velocity_in_world;
    EXPECT_LT(std::abs(velocity.y()), 0.06) << time;
  }
}

TEST_P(PlannedDrive, StaysOnTheGround) {
  for (double time = 0; time <= 40; time += 0.1) {
    const Rigid3 world_from_body = plan_.motion.WorldFromBody(time);
    const Eigen::Vector3d& at = world_from_body.translation;
    EXPECT_NEAR(at.z(), place_.ground.Height(at.head<2>(), at.z()), 0.003) << time;
    const Eigen::Vector3d up = world_from_body.rotation * Eigen::Vector3d::UnitZ();
    EXPECT_LT((up - place_.ground.Normal(at.head<2>(), at.z())).norm(), 0.025) << time;
  }
}

TEST_P(PlannedDrive, TouchesNeitherParkedCarsNorKerbs) {
  const double front = -RearAxleX(kOwnCarStyle) + 3.95 / 2, rear = front - 3.95;
  for (double time = 0; time <= 40; time += 0.2) {
    const Rigid3 world_from_body = plan_.motion.WorldFromBody(time);
    double clearance = 1e9;
    for (double x = rear; x <= front + 0.01; x += 0.2) {
      for (const double y : {-0.9, 0.9}) {
        const Eigen::Vector2d corner = (world_from_body * Eigen::Vector3d(x, y, 0)).head<2>();
        for (const ParkedCar& car : layout_.cars)
          clearance = std::min(clearance, car.footprint.SignedDistance(corner));
        for (const Rectangle& island : layout_.islands)
          clearance = std::min(clearance, island.SignedDistance(corner));
        clearance = std::min({clearance, corner.x(), corner.y(), layout_.length - corner.x(),
                              layout_.width - corner.y()});
      }
    }
    EXPECT_GT(clearance, 0.3) << time;
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, PlannedDrive, testing::Values(1, 2, 3, 4, 17));

TEST(PlanDrive, ALongDriveMakesSeveralRounds) {
  const DrivePlan plan = PlanDrive(PlanPlace("lot", {.seed = 1}), 120, 1);

  EXPECT_TRUE(plan.returns_to_start);
  EXPECT_GT(plan.length, 280);
}

TEST(PlanDrive, ADriveHasTheLengthAskedFor) {
  const Place place = PlanPlace("lot", {.seed = 3});
  for (const double length : {44.0, 194.0, 437.0}) {
    const DrivePlan plan = PlanDrive(place, {.length = length}, 0, 3);
    EXPECT_NEAR(plan.length, length, 0.09 * length);
    EXPECT_LE(plan.max_speed, 6.01);
  }
}

TEST(PlanDrive, TheOtherWayAroundIsTheOtherWayAround) {
  const Place place = PlanPlace("lot", {.seed = 3});
  const auto direction_at = [&](const DrivePlan& plan) {
    return Eigen::Vector3d(plan.motion.WorldFromBody(0).rotation * Eigen::Vector3d::UnitX());
  };
  const DrivePlan forth = PlanDrive(place, {.length = 150}, 0, 3),
                  back = PlanDrive(place, {.length = 150, .is_opposite = true}, 0, 3);

  EXPECT_LT(direction_at(forth).dot(direction_at(back)), -0.9);
}

TEST(PlanDrive, ABumpLiftsOneAxleAfterTheOther) {
  Place road;
  road.ground = Ground({{.min = {-10, -10},
                         .max = {80, 10},
                         .height =
                             [](const Eigen::Vector2d& xy) {
                               return 0.08 * std::exp(-std::pow((xy.x() - 30) / 0.4, 2));
                             },
                         .covers = {}}});
  road.plan_route = [](const RouteWish&) {
    return RoutePlan{.waypoints = {{0, 0, 0}, {60, 0, 0}}, .slot = {}};
  };
  const DrivePlan plan = PlanDrive(road, {.length = 60, .stops = {}, .suspension = 0}, 0, 1);
  double highest = 0, highest_at = 0, steepest = 0, steepest_at = 0;
  for (double time = 0; time < plan.motion.Duration(); time += 0.01) {
    const Rigid3 world_from_body = plan.motion.WorldFromBody(time);
    const double rise = (world_from_body.rotation * Eigen::Vector3d::UnitX()).z();
    if (world_from_body.translation.z() > highest) {
      highest = world_from_body.translation.z();
      highest_at = world_from_body.translation.x();
    }
    if (rise > steepest) {
      steepest = rise;
      steepest_at = world_from_body.translation.x();
    }
  }

  EXPECT_NEAR(highest_at, 30, 0.1);
  EXPECT_NEAR(highest, 0.08, 0.015);
  EXPECT_NEAR(steepest_at, 30 - Wheelbase(kOwnCarStyle), 0.1);  // the front axle is on it
  EXPECT_NEAR(steepest, 0.08 / Wheelbase(kOwnCarStyle), 0.005);
}

/// Drives that end in a slot, on several lots.
class ParkingDrive : public testing::TestWithParam<int> {
 protected:
  const std::uint64_t seed_ = static_cast<std::uint64_t>(GetParam());
  const LotLayout layout_ = PlanLot(seed_);
  const Place place_ = PlanPlace("lot", {.seed = seed_});
  const DrivePlan plan_ =
      PlanDrive(place_, {.length = 60, .parks = true, .leaves_slot = true}, 0, seed_);
};

TEST_P(ParkingDrive, BacksIntoAFreeSlotAndLeavesItAgain) {
  ASSERT_TRUE(plan_.is_parked);
  EXPECT_EQ(plan_.num_reversals, 2);
  EXPECT_GE(plan_.min_radius, 5);
  EXPECT_NEAR(plan_.length, 60, 1);
  bool was_in_slot = false;
  for (double time = 0; time < plan_.motion.Duration(); time += 0.1) {
    const MotionState state = plan_.motion.At(time);
    if (state.velocity_in_world.norm() > 1e-3) continue;
    const Eigen::Vector2d middle =
        (state.world_from_body * Eigen::Vector3d(-RearAxleX(kOwnCarStyle), 0, 0)).head<2>();
    for (const ParkingSlot& slot : place_.slots)
      was_in_slot =
          was_in_slot || (!slot.is_occupied && (slot.outline.center - middle).norm() < 0.3);
  }
  EXPECT_TRUE(was_in_slot);
}

TEST_P(ParkingDrive, TouchesNoCarAndIsSmoothThroughout) {
  ASSERT_FALSE(layout_.cars.empty());
  ASSERT_GT(plan_.motion.Duration(), 1);
  MotionState last = plan_.motion.At(0);
  for (double time = 0.01; time < plan_.motion.Duration(); time += 0.01) {
    const MotionState state = plan_.motion.At(time);
    EXPECT_LT((state.world_from_body.translation - last.world_from_body.translation).norm(), 0.08)
        << time;
    EXPECT_LT((state.velocity_in_world - last.velocity_in_world).norm(), 0.05) << time;
    EXPECT_LT((state.acceleration_in_world - last.acceleration_in_world).norm(), 0.6) << time;
    EXPECT_LT((state.angular_velocity_in_body - last.angular_velocity_in_body).norm(), 0.03)
        << time;
    last = state;
    for (const double x : {-0.7, 1.2, 3.2}) {
      for (const double y : {-0.85, 0.85}) {
        const Eigen::Vector2d corner = (state.world_from_body * Eigen::Vector3d(x, y, 0)).head<2>();
        for (const ParkedCar& car : layout_.cars)
          EXPECT_GT(car.footprint.SignedDistance(corner), 0.05) << time;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, ParkingDrive, testing::Values(1, 2, 5));

}  // namespace
}  // namespace parkade::simulator
