#include "mapping/roadside/parking_lane.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace parkade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kKerb = 4.0;  // [m] right of a path along x

/// `end` and `free_width` by the place along the path [m].
template <typename Section>
ParkingLane LaneOf(double length, const Section& section) {
  Roadside roadside;
  for (double x = 0; x < length; x += Roadside::kStep) {
    const auto [free_width, end] = section(x);
    roadside.sections.push_back({Vector3d(x, 0, 0.5), Vector2d(0, -1), free_width, end});
  }
  return FindParkingLane(roadside);
}

struct Seen {
  double free_width;
  RoadsideEnd end;
};

auto Count(const ParkingLane& lane, LaneState state) {
  return std::count(lane.states.begin(), lane.states.end(), state);
}

TEST(FindParkingLane, LiesBeforeTheKerb) {
  const ParkingLane lane = LaneOf(30, [](double) { return Seen{kKerb, RoadsideEnd::kOther}; });
  ASSERT_GT(lane.places.size(), 140U);
  for (const Vector3d& place : lane.places) EXPECT_NEAR(place.y(), -3, 0.1);
  EXPECT_NEAR((lane.places[100] - lane.places[0]).norm(), 100 * ParkingLane::kStep, 1e-9);
  EXPECT_EQ(Count(lane, LaneState::kFree), static_cast<int>(lane.states.size()));
}

TEST(FindParkingLane, FlanksOfCarsTellTheKerbThatTheyHide) {
  const ParkingLane lane = LaneOf(30, [](double x) {
    return x < 28 ? Seen{kKerb - 1.95, RoadsideEnd::kVehicle} : Seen{0, RoadsideEnd::kUnseen};
  });
  ASSERT_FALSE(lane.places.empty());
  for (const Vector3d& place : lane.places) EXPECT_NEAR(place.y(), -3, 0.1);
  EXPECT_NEAR(static_cast<double>(Count(lane, LaneState::kVehicle)) * ParkingLane::kStep, 28, 0.5);
}

TEST(FindParkingLane, AMouthWithoutAKerbIsNoPlaceToPark) {
  const ParkingLane lane = LaneOf(40, [](double x) {
    return std::abs(x - 20) < 4 ? Seen{9, RoadsideEnd::kUnseen} : Seen{kKerb, RoadsideEnd::kOther};
  });
  EXPECT_NEAR(static_cast<double>(Count(lane, LaneState::kBlocked)) * ParkingLane::kStep, 8, 0.5);
}

TEST(FindParkingLane, WhereNothingTellsThereIsNone) {
  EXPECT_TRUE(LaneOf(30, [](double) { return Seen{0, RoadsideEnd::kUnseen}; }).places.empty());
  EXPECT_TRUE(FindParkingLane({}).places.empty());
}

}  // namespace
}  // namespace parkade
