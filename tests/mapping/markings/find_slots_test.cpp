#include "mapping/markings/find_slots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/mapping/roadside/street_world.h"
#include "tests/mapping/worlds/flat_ground.h"

namespace parkade {
namespace {

using Eigen::Vector2d;

constexpr int kNumSlots = 9;                 // of each of two rows
constexpr double kPitch = 2.5, kLeft = -11;  // [m]
const cv::Scalar kWhite = cv::Scalar::all(200);

/// Two rows, above and below an aisle; `shift` [m] is along them.
void PaintRows(PaintedGround& ground, double shift = 0, const cv::Scalar& color = kWhite) {
  for (int i = 0; i <= kNumSlots; ++i) {
    const double x = kLeft + shift + kPitch * i;
    ground.Line({x, 3}, {x, 8}, 0.12, color);
    ground.Line({x, -8}, {x, -3}, 0.12, color);
  }
}

/// What a drive saw of all the ground but some squares, where something stood.
PosedGroundPatch PatchOf(int drive, const std::vector<Eigen::AlignedBox2d>& cars = {}) {
  PosedGroundPatch posed;
  posed.patch.drive = drive;
  posed.site_from_body.translation.z() = 1.5;
  for (double x = -14; x < 14; x += 0.1)
    for (double y = -9; y < 9; y += 0.1) {
      GroundSample sample;
      sample.point_in_body = Eigen::Vector3f(static_cast<float>(x), static_cast<float>(y), 0);
      sample.is_free = std::none_of(cars.begin(), cars.end(),
                                    [&](const auto& car) { return car.contains(Vector2d(x, y)); });
      posed.patch.samples.push_back(sample);
    }
  return posed;
}

std::vector<ParkingSlot> Look(const PaintedGround& painted,
                              const std::vector<PosedGroundPatch>& patches,
                              std::vector<SlotLook> known = {}) {
  const FlatGround ground(painted.tile());
  const PatchesInMemory source(patches);
  const MarkedGround marked{ground.mesh, ground.surface, ground.texture,  source,
                            {},          patches.size(), std::move(known)};
  return FindSlots(marked, FindPaint(marked));
}

/// The slots of the first day, named.
std::vector<SlotLook> FirstDay() {
  PaintedGround painted;
  PaintRows(painted);
  SlotLook look{Look(painted, {PatchOf(0)}), 0};
  for (std::size_t i = 0; i < look.slots.size(); ++i) look.slots[i].id = std::to_string(i);
  return {look};
}

std::size_t CountNamed(const std::vector<ParkingSlot>& slots) {
  std::set<std::string> ids;
  for (const ParkingSlot& slot : slots)
    if (!slot.id.empty()) ids.insert(slot.id);
  return ids.size();
}

TEST(FindSlots, ASecondDayWithCarsAndShadowsLosesNone) {
  PaintedGround second;
  PaintRows(second, 0.03, cv::Scalar::all(150));
  std::vector<Eigen::AlignedBox2d> cars;
  for (const int slot : {0, 1, 2, 4, 5, 7, 8}) {
    const double x = kLeft + kPitch * slot;
    cars.emplace_back(Vector2d(x + 0.1, 2.8), Vector2d(x + 2.4, 7.7));
    second.Hide({x - 0.4, 2.6}, {x + 2.8, 8.4});
  }
  for (int i = 0; i < 8; ++i) {  // of trees and posts, across the other row
    const double x = kLeft + 2.9 * i;
    second.Shade({{x, -9}, {x + 1.3, -9}, {x + 3.2, -2}, {x + 1.7, -2}}, 0.35);
  }
  const std::vector<PosedGroundPatch> patches = {PatchOf(0), PatchOf(1, cars)};
  const std::vector<SlotLook> known = FirstDay();
  ASSERT_EQ(known[0].slots.size(), 2U * kNumSlots);
  EXPECT_LT(Look(second, patches).size(), 1.2 * kNumSlots) << "of what the second day shows";

  const std::vector<ParkingSlot> slots = Look(second, patches, known);
  EXPECT_EQ(CountNamed(slots), 2U * kNumSlots);
  EXPECT_EQ(slots.size(), 2U * kNumSlots) << "shadows add none";
  EXPECT_EQ(
      std::count_if(slots.begin(), slots.end(),
                    [](const ParkingSlot& slot) { return slot.states[1] == SlotState::kOccupied; }),
      7);
}

TEST(FindSlots, ThatAreFoundAgainAFewCentimetersAsideKeepTheirNames) {
  PaintedGround second;
  PaintRows(second, 0.12);
  const std::vector<ParkingSlot> slots = Look(second, {PatchOf(0), PatchOf(1)}, FirstDay());
  EXPECT_EQ(slots.size(), 2U * kNumSlots);
  EXPECT_EQ(CountNamed(slots), 2U * kNumSlots);
}

TEST(FindSlots, OfARowPaintedAnewReplaceTheOldOnes) {
  PaintedGround second;
  PaintRows(second, kPitch / 2);
  const std::vector<PosedGroundPatch> patches = {PatchOf(0), PatchOf(1)};
  const std::vector<ParkingSlot> slots = Look(second, patches, FirstDay());
  EXPECT_EQ(CountNamed(slots), 0U);
  EXPECT_EQ(slots.size(), 2U * kNumSlots);
}

TEST(FindSlots, WhosePaintIsGoneAreGoneOnceTheirGroundIsSeen) {
  const std::vector<PosedGroundPatch> free = {PatchOf(0), PatchOf(1)};
  EXPECT_TRUE(Look(PaintedGround(), free, FirstDay()).empty());
  const std::vector<Eigen::AlignedBox2d> all = {{Vector2d(-14, 2), Vector2d(14, 9)},
                                                {Vector2d(-14, -9), Vector2d(14, -2)}};
  const std::vector<PosedGroundPatch> hidden = {PatchOf(0), PatchOf(1, all)};
  EXPECT_EQ(Look(PaintedGround(), hidden, FirstDay()).size(), 2U * kNumSlots);
}

/// The slots of an unpainted street with cars, each about an x [m].
std::vector<ParkingSlot> LookAtStreet(const std::vector<double>& cars,
                                      std::vector<SlotLook> known = {}) {
  const SurfaceMap surface = StreetWithCars(40, cars);
  const DrivenPath path = PathAlongStreet(32);
  const TriangleMesh mesh;
  const GroundTexture texture;
  const PatchesInMemory nothing({});
  const MarkedGround marked{mesh, surface,         texture, nothing, std::span(&path, 1),
                            1,    std::move(known)};
  return FindSlots(marked, {});
}

TEST(FindSlots, CarsAlongAKerbAreSlotsThatNoLineDivides) {
  const std::vector<ParkingSlot> slots = LookAtStreet({16.2, 22.4});
  ASSERT_EQ(slots.size(), 4U) << "two cars, and a place beyond each";
  for (const ParkingSlot& slot : slots) {
    EXPECT_EQ(slot.kind, SlotKind::kParallel);
    EXPECT_EQ(slot.num_marked_sides, 0);
    EXPECT_NEAR(slot.Length(), 6.2, 0.2);
    EXPECT_NEAR(0.5 * (slot.corners[0] + slot.corners[1]).y(), -3.1, 0.1) << "from the lane";
    EXPECT_NEAR(slot.Center().z(), 0.2, 0.01);
  }
}

TEST(FindSlots, AlongAKerbALaterDayAddsItsCarsAndLosesNone) {
  SlotLook first{LookAtStreet({16.2, 22.4}), 0};
  for (std::size_t i = 0; i < first.slots.size(); ++i) first.slots[i].id = std::to_string(i);
  EXPECT_EQ(LookAtStreet({}, {first}).size(), first.slots.size());
  const std::vector<ParkingSlot> both = LookAtStreet({28.7, 34.9}, {first});
  ASSERT_EQ(both.size(), 5U) << "the one beyond the first day's last car has a car now";
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(both[i].id, std::to_string(i));
  EXPECT_GT(both[3].confidence, first.slots[3].confidence) << "of that car";
  EXPECT_TRUE(both[4].id.empty());
}

TEST(FindSlots, NearMarkedSlotsCarsAloneMakeNone) {
  ParkingSlot marked;
  marked.corners = {Eigen::Vector3d(18, 0, 0.2), {20.4, 0, 0.2}, {20.4, 2.4, 0.2}, {18, 2.4, 0.2}};
  marked.confidence = 0.9;
  const std::vector<ParkingSlot> slots = LookAtStreet({16.2, 22.4}, {{{marked}, 0}});
  EXPECT_TRUE(std::all_of(slots.begin(), slots.end(), [](const ParkingSlot& slot) {
    return slot.kind == SlotKind::kPerpendicular;
  }));
}

TEST(FindSlots, BesideMarkedParallelOnesCarsMakeSlots) {
  ParkingSlot marked = LookAtStreet({16.2, 22.4}).front();
  marked.num_marked_sides = 2;
  marked.confidence = 0.85;
  const std::vector<ParkingSlot> slots = LookAtStreet({16.2, 22.4}, {{{marked}, 0}});
  EXPECT_EQ(slots.size(), 4U);
  EXPECT_EQ(std::count_if(slots.begin(), slots.end(),
                          [](const ParkingSlot& slot) { return slot.num_marked_sides == 2; }),
            1);
}

}  // namespace
}  // namespace parkade
