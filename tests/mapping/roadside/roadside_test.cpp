#include "mapping/roadside/roadside.h"

#include <gtest/gtest.h>

#include "tests/mapping/roadside/street_world.h"

namespace parkade {
namespace {

/// What the right or the left side of the path has nearest to x [m].
RoadsideSection SectionAt(const Roadside& side, double x) {
  RoadsideSection nearest = side.sections.front();
  for (const RoadsideSection& section : side.sections)
    if (std::abs(section.place.x() - x) < std::abs(nearest.place.x() - x)) nearest = section;
  return nearest;
}

TEST(LookBeside, FreeGroundEndsAtCarsAndKerbs) {
  const SurfaceMap surface = StreetWithCars(40, {20});
  const DrivenPath path = PathAlongStreet(32);
  const std::vector<Roadside> sides = LookBeside(CellFinder(surface), std::span(&path, 1));
  ASSERT_EQ(sides.size(), 2U);
  const RoadsideSection car = SectionAt(sides[0], 20), kerb = SectionAt(sides[0], 26),
                        left = SectionAt(sides[1], 20);
  EXPECT_EQ(car.end, RoadsideEnd::kVehicle);
  EXPECT_NEAR(car.free_width, 2.1, 0.11);
  EXPECT_NEAR(car.place.z(), 0.2, 1e-6) << "on the ground";
  EXPECT_EQ(kerb.end, RoadsideEnd::kOther);
  EXPECT_NEAR(kerb.free_width, 4, 0.11);
  EXPECT_EQ(left.end, RoadsideEnd::kOther);
  EXPECT_NEAR(left.free_width, 6, 0.11);
  EXPECT_NEAR(left.At(1).y(), 0, 1e-6);
}

TEST(LookBeside, GoesOnBeyondTheEndsOfAPathWithTheRoadsideOnItsRight) {
  const SurfaceMap surface = StreetWithCars(40, {});
  const DrivenPath path = PathAlongStreet(30);
  for (const Roadside& side : LookBeside(CellFinder(surface), std::span(&path, 1))) {
    const auto [low, high] =
        std::minmax(side.sections.front().place.x(), side.sections.back().place.x());
    EXPECT_NEAR(low, 0, 0.2);
    EXPECT_NEAR(high, 38, 0.3);
    const Eigen::Vector2d along =
        (side.sections.back().place - side.sections.front().place).head<2>().normalized();
    EXPECT_NEAR(side.sections[50].outward.dot(Eigen::Vector2d(along.y(), -along.x())), 1, 1e-6);
  }
}

TEST(LookBeside, APlaceWithoutGroundIsUnseen) {
  const DrivenPath path = PathAlongStreet(30);
  const SurfaceMap nothing;
  for (const Roadside& side : LookBeside(CellFinder(nothing), std::span(&path, 1)))
    for (const RoadsideSection& section : side.sections)
      EXPECT_EQ(section.end, RoadsideEnd::kUnseen);
}

}  // namespace
}  // namespace parkade
