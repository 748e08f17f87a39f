#include "tests/simulator/ground/ground.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/simulator/layouts/garage_layout.h"
#include "tests/simulator/layouts/garage_place.h"
#include "tests/simulator/layouts/place.h"
#include "tests/simulator/layouts/plan_place.h"
#include "tests/simulator/motion/ramp_profile.h"
#include "tests/simulator/motion/route.h"

namespace parkade::simulator {
namespace {

using Eigen::Vector2d;

TEST(RampProfile, ReachesItsRiseWithinItsSlope) {
  const RampProfile ramp{.rise = 2.9, .run = 26.5, .transition = 5};

  EXPECT_EQ(ramp.Height(-1), 0);
  EXPECT_NEAR(ramp.Height(26.5), 2.9, 1e-12);
  EXPECT_NEAR(ramp.Height(13.25), 1.45, 1e-9);
  EXPECT_GT(ramp.Slope(), 0.12);
  EXPECT_LT(ramp.Slope(), 0.15);
}

TEST(RampProfile, BendsSmoothly) {
  const RampProfile ramp;
  const double h = 1e-3;
  double last = 0;
  for (double along = -2; along < ramp.run + 2; along += 0.05) {
    const double bend =
        (ramp.Height(along + h) - 2 * ramp.Height(along) + ramp.Height(along - h)) / (h * h);
    EXPECT_LT(std::abs(bend - last), 0.004) << along;  // a kink would jump by 0.05
    last = bend;
  }
}

TEST(Ground, TheSheetNearestToTheHintAnswers) {
  const GarageLayout garage = PlanGarage(3, 0);
  const Place place = MakeGaragePlace(garage, {.seed = 3});
  const Vector2d in_aisle(20, garage.decks[0].aisle_y[0]);

  EXPECT_EQ(place.ground.Height(in_aisle, 0.4), 0);
  EXPECT_EQ(place.ground.Height(in_aisle, 2.5), garage.storey);
  EXPECT_EQ(place.ground.Height(in_aisle, 5.0), 2 * garage.storey);
  EXPECT_EQ(place.ground.SheetAt({-10, 10}, 6), garage.ForecourtSheet())
      << "only one sheet is there";
  const Vector2d on_ramp((garage.ramp_from + garage.ramp_to) / 2, garage.width + 2);
  EXPECT_NEAR(place.ground.Height(on_ramp, 1.0), garage.storey / 2, 1e-6);
  EXPECT_NEAR(place.ground.Height(on_ramp, 4.0), 1.5 * garage.storey, 1e-6);
}

TEST(Ground, RampsMeetTheDecksWithoutStepOrKink) {
  const GarageLayout garage = PlanGarage(5, 0);
  const Place place = MakeGaragePlace(garage, {.seed = 5});
  const double y = garage.width + 2.5, angle = 1e-4;
  const auto on_curve = [&](double turn) -> Vector2d {
    return Vector2d(garage.length, garage.curve_y) +
           garage.curve_radius * Vector2d(std::sin(turn), -std::cos(turn));
  };
  for (int deck = 0; deck < garage.num_ramps(); ++deck) {
    const double low = deck * garage.storey, high = low + garage.storey;
    for (const double offset : {-0.01, 0.01}) {
      EXPECT_NEAR(place.ground.Height({garage.ramp_from + offset, y}, low), low, 1e-6);
      EXPECT_NEAR(place.ground.Height({garage.ramp_to + offset, y}, high), high, 1e-6);
      EXPECT_LT(place.ground.Gradient({garage.ramp_from + offset, y}, low).norm(), 1e-6);
      EXPECT_LT(place.ground.Gradient({garage.ramp_to + offset, y}, high).norm(), 1e-6);
    }
    EXPECT_NEAR(place.ground.Height(on_curve(angle), low), low, 1e-6);
    EXPECT_NEAR(place.ground.Height(on_curve(M_PI - angle), high), high, 1e-6);
  }
}

TEST(Ground, SpeedBumpsRaiseItSmoothlyWhereCarsDrive) {
  const Place flat = PlanPlace("lot", {.seed = 3, .relief = 0}),
              bumpy = PlanPlace("lot", {.seed = 3, .relief = 0, .speed_bumps = 2});
  const RoutePlan plan = bumpy.plan_route({.length = 150});
  const Route route(plan.waypoints, plan.corner_radius);
  double highest = 0, last_slope = 0, sharpest = 0;
  for (double s = 0.05; s < route.Length(); s += 0.05) {
    const double height = bumpy.ground.Height(route.Position(s), 0),
                 slope = (height - bumpy.ground.Height(route.Position(s - 0.05), 0)) / 0.05;
    highest = std::max(highest, height - flat.ground.Height(route.Position(s), 0));
    if (s > 0.06) sharpest = std::max(sharpest, std::abs(slope - last_slope) / 0.05);
    last_slope = slope;
  }

  EXPECT_GT(highest, 0.05);
  EXPECT_LT(highest, 0.061);
  EXPECT_LT(sharpest, 0.12);  // [1/m] of curvature: a kink would show as one of 1
}

class PlacedRoute : public testing::TestWithParam<const char*> {};

TEST_P(PlacedRoute, RunsOnDrivableGroundWithoutStepsBothWays) {
  const Place place = PlanPlace(GetParam(), {.seed = 4});
  for (const bool is_reversed : {false, true}) {
    for (const bool turns_around : {false, true}) {
      const RoutePlan plan = place.plan_route(
          {.length = 450, .is_reversed = is_reversed, .turns_around = turns_around, .seed = 4});
      const Route route(plan.waypoints, plan.corner_radius);
      double last_height = place.ground.Height(route.Position(0), route.HeightHint(0));
      const double first_height = place.ground.Height(route.Position(0.1), route.HeightHint(0.1));
      double last_slope = (first_height - last_height) / 0.1, max_curvature = 0;
      last_height = first_height;
      for (double s = 0.2; s < route.Length(); s += 0.1) {
        const Vector2d xy = route.Position(s);
        const size_t sheet = place.ground.SheetAt(xy, route.HeightHint(s));
        EXPECT_TRUE(place.ground.sheets()[sheet].Covers(xy) && place.is_drivable(sheet, xy))
            << GetParam() << " at " << xy.transpose() << " s " << s
            << (is_reversed ? " reversed" : "");
        const double height = place.ground.Height(xy, route.HeightHint(s)),
                     slope = (height - last_height) / 0.1;
        EXPECT_LT(std::abs(slope), 0.2) << xy.transpose();
        EXPECT_LT(std::abs(slope - last_slope), 0.02) << xy.transpose();
        last_height = height;
        last_slope = slope;
        max_curvature = std::max(max_curvature, std::abs(route.Curvature(s)));
      }
      EXPECT_LT(max_curvature, 1 / 5.0);
    }
  }
}

TEST_P(PlacedRoute, ComesNearTheLengthWishedFor) {
  const Place place = PlanPlace(GetParam(), {.seed = 2});
  for (const double length : {350.0, 720.0}) {
    const RoutePlan plan = place.plan_route({.length = length});
    EXPECT_NEAR(Route(plan.waypoints, plan.corner_radius).Length(), length, 0.35 * length)
        << length;
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, PlacedRoute, testing::Values("lot", "garage", "street"));

TEST(Garage, ToursReachTheHighestDeckUnderTheRoofAndComeBackToTheForecourt) {
  const Place place = PlanPlace("garage", {.seed = 2});
  const RoutePlan plan = place.plan_route({.length = 600});
  const Route route(plan.waypoints, plan.corner_radius);
  double highest = 0;
  int num_covered = 0, num_steps = 0;
  for (double s = 0; s < route.Length(); s += 1) {
    const Vector2d xy = route.Position(s);
    const double height = place.ground.Height(xy, route.HeightHint(s));
    highest = std::max(highest, height);
    num_covered += place.is_covered({xy.x(), xy.y(), height + 1.5});
    ++num_steps;
  }

  EXPECT_NEAR(highest, 2 * PlanGarage(2, 0).storey, 1e-6);
  EXPECT_GT(num_covered, 0.6 * num_steps);
  EXPECT_FALSE(place.is_covered({plan.waypoints.front().x(), plan.waypoints.front().y(), 1.5}));
  EXPECT_LT((plan.waypoints.front() - plan.waypoints.back()).norm(), 4);
}

TEST(Place, AnotherDayParksOtherCarsInTheSameSlots) {
  for (const char* name : {"lot", "garage", "street"}) {
    const Place first = PlanPlace(name, {.seed = 6}), same = PlanPlace(name, {.seed = 6}),
                second = PlanPlace(name, {.seed = 6, .day = 1});
    ASSERT_EQ(first.slots.size(), second.slots.size());
    int num_changed = 0, num_occupied = 0;
    for (size_t i = 0; i < first.slots.size(); ++i) {
      EXPECT_EQ(first.slots[i].outline.center, second.slots[i].outline.center);
      EXPECT_EQ(first.slots[i].is_occupied, same.slots[i].is_occupied);
      num_changed += first.slots[i].is_occupied != second.slots[i].is_occupied;
      num_occupied += first.slots[i].is_occupied;
    }
    EXPECT_GT(num_changed, 10) << name;
    EXPECT_GT(num_occupied, static_cast<int>(first.slots.size()) / 3) << name;
    EXPECT_LT(num_occupied, static_cast<int>(first.slots.size())) << name;
  }
}

/// Share of a place's slots on its lowest level that another place has within a hand's breadth.
double SharedSlots(const Place& place, const Place& other) {
  int num_slots = 0, num_shared = 0;
  for (const ParkingSlot& slot : place.slots) {
    if (slot.height > 1) continue;
    ++num_slots;
    num_shared += std::any_of(other.slots.begin(), other.slots.end(), [&](const ParkingSlot& one) {
      return one.height < 1 && (one.outline.center - slot.outline.center).norm() < 0.1;
    });
  }
  return static_cast<double>(num_shared) / num_slots;
}

class PlacesOfSeeds : public testing::TestWithParam<std::pair<const char*, int>> {};

/// By chance two may be alike, as in the world.
TEST_P(PlacesOfSeeds, DoNotShareTheirPlan) {
  const auto& [name, num_seeds] = GetParam();
  std::vector<Place> places;
  for (int seed = 1; seed <= num_seeds; ++seed)
    places.push_back(PlanPlace(name, {.seed = static_cast<std::uint64_t>(seed), .relief = 0}));
  int num_pairs = 0, num_alike = 0;
  for (size_t i = 0; i < places.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      ++num_pairs;
      num_alike += SharedSlots(places[i], places[j]) > 0.5;
    }
  }

  EXPECT_LE(num_alike, 0.005 * num_pairs) << "of " << num_pairs;
  RecordProperty("alike", num_alike);
}

INSTANTIATE_TEST_SUITE_P(Scenes, PlacesOfSeeds,
                         testing::Values(std::pair("lot", 50), std::pair("garage", 50),
                                         std::pair("street", 8)),
                         [](const auto& info) { return std::string(info.param.first); });

TEST(Garage, EveryDeckHasTheSamePlan) {
  const Place place = PlanPlace("garage", {.seed = 6});
  const size_t num_on_deck = place.slots.size() / 3;
  for (size_t i = 0; i < num_on_deck; ++i)
    for (const size_t deck : {size_t{1}, size_t{2}})
      EXPECT_EQ(place.slots[i].outline.center, place.slots[i + deck * num_on_deck].outline.center);
}

TEST(Place, ASlotToEndInIsFreeAndBesideTheWay) {
  for (const char* name : {"lot", "garage"}) {
    const RoutePlan plan =
        PlanPlace(name, {.seed = 3}).plan_route({.length = 200, .ends_in_slot = true});
    ASSERT_TRUE(plan.slot) << name;
    EXPECT_FALSE(plan.slot->is_occupied);
  }
}

}  // namespace
}  // namespace parkade::simulator
