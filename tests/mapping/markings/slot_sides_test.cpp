#include "mapping/markings/slot_sides.h"

#include <gtest/gtest.h>

#include "tests/mapping/worlds/flat_ground.h"

namespace parkade {
namespace {

using Eigen::Vector3d;

ParkingSlot Slot() {
  ParkingSlot slot;
  slot.corners = {Vector3d(2, 2, 1.5), {4.5, 2, 1.5}, {4.5, 7, 1.5}, {2, 7, 1.5}};
  return slot;
}

SlotSides SidesOf(const PaintedGround& painted) {
  const FlatGround ground(painted.tile());
  return SeeSides(GroundTiles(ground.mesh, ground.surface, ground.texture, 7), {Slot()})[0];
}

constexpr SlotSides Both(PaintSeen seen) { return {seen, seen}; }

TEST(SlotSides, FaintPaintIsSeenAndItsAbsenceToo) {
  EXPECT_EQ(SidesOf(PaintedGround()), Both(PaintSeen::kBare));
  PaintedGround painted;
  painted.Line({2.05, 2}, {2.05, 7}, 0.12, cv::Scalar::all(124));
  EXPECT_EQ(SidesOf(painted), (SlotSides{PaintSeen::kBare, PaintSeen::kPainted}));
}

TEST(SlotSides, ALineWornAwayButForSomeDashesIsNotBare) {
  PaintedGround painted;
  painted.Line({4.5, 2}, {4.5, 7}, 0.12, cv::Scalar::all(160), 5);
  EXPECT_NE(SidesOf(painted)[0], PaintSeen::kBare);
}

TEST(SlotSides, MarksAtTheCornersArePaint) {
  PaintedGround painted;
  painted.Line({4.5, 2}, {4.5, 2.9}, 0.12, cv::Scalar::all(124));
  EXPECT_EQ(SidesOf(painted), (SlotSides{PaintSeen::kPainted, PaintSeen::kBare}));
}

TEST(SlotSides, WhatIsHiddenOrAtTheEdgeOfAShadowIsUnknown) {
  PaintedGround painted;
  painted.Hide({1.5, 3}, {4.6, 6.5});
  EXPECT_EQ(SidesOf(painted), Both(PaintSeen::kUnknown));
  PaintedGround shaded;
  shaded.Polygon({{2, 1}, {4.45, 1}, {4.45, 8}, {2, 8}}, cv::Scalar::all(50));
  EXPECT_EQ(SidesOf(shaded), Both(PaintSeen::kUnknown));
}

}  // namespace
}  // namespace parkade
