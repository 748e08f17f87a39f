#include "mapping/markings/corner_marks.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "mapping/ground/quadrilateral.h"
#include "mapping/markings/slot_rows.h"

namespace parkade {
namespace {

using Eigen::Vector2d;

constexpr double kDepth = 5.1;  // [m] as is usual

PaintLine Stroke(const Vector2d& begin, const Vector2d& end, double height = 0) {
  PaintLine line;
  line.begin = begin, line.end = end, line.height = height;
  line.width = 0.11, line.contrast = 0.4;
  line.is_begin_seen = line.is_end_seen = true;
  return line;
}

/// Ts at the entrances of slots side by side; the row runs to the right, the slots lie above it.
struct Tees {
  Vector2d start = {3, -2};
  double yaw = 0.3, pitch = 2.5, height = 0;

  Vector2d Along() const { return {std::cos(yaw), std::sin(yaw)}; }
  Vector2d Into() const { return {-std::sin(yaw), std::cos(yaw)}; }
  Vector2d Corner(int index) const { return start + index * pitch * Along(); }

  void Paint(int index, std::vector<PaintLine>& lines) const {
    const Vector2d corner = Corner(index);
    lines.push_back(Stroke(corner - 0.45 * Along(), corner + 0.45 * Along(), height));
    lines.push_back(Stroke(corner + 0.05 * Into(), corner + 0.9 * Into(), height));
  }
  std::vector<PaintLine> Paint(std::initializer_list<int> indices) const {
    std::vector<PaintLine> lines;
    for (const int index : indices) Paint(index, lines);
    return lines;
  }
  Quadrilateral Slot(int index, double depth = kDepth) const {
    const Vector2d a = Corner(index), b = Corner(index + 1);
    return {a, b, b + depth * Into(), a + depth * Into()};
  }
};

std::vector<PlanarSlot> Find(const std::vector<PaintLine>& lines) {
  return FindSlotsAtMarks(lines, std::vector<bool>(lines.size()), kDepth, {});
}

bool Has(const std::vector<PlanarSlot>& slots, const Quadrilateral& truth) {
  return std::any_of(slots.begin(), slots.end(),
                     [&](const PlanarSlot& slot) { return OverlapOf(slot.corners, truth) > 0.95; });
}

TEST(CornerMarks, TeesInLineAreARow) {
  const Tees tees;
  const std::vector<PlanarSlot> slots = Find(tees.Paint({0, 1, 2, 3, 4}));

  ASSERT_EQ(slots.size(), 4U);
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(Has(slots, tees.Slot(i))) << i;
  for (const PlanarSlot& slot : slots) {
    EXPECT_GT(SignedArea(slot.corners), 0);
    EXPECT_EQ(slot.kind, SlotKind::kPerpendicular);
    EXPECT_NEAR(slot.angle, std::numbers::pi / 2, 1e-12);
    EXPECT_EQ(slot.num_marked_sides, 2);
    EXPECT_GT(slot.confidence, 0.8);
  }
}

TEST(CornerMarks, ParallelSlotsLieFurtherApart) {
  const Tees tees{.pitch = 6.1};
  const std::vector<PlanarSlot> slots = Find(tees.Paint({0, 1, 2}));

  ASSERT_EQ(slots.size(), 2U);
  EXPECT_TRUE(Has(slots, tees.Slot(0, 2.0)));
  EXPECT_TRUE(Has(slots, tees.Slot(1, 2.0)));
  EXPECT_EQ(slots[0].kind, SlotKind::kParallel);
  EXPECT_LT(slots[0].confidence, 0.8);
}

TEST(CornerMarks, AMissingOneFollowsFromItsRow) {
  const Tees tees;
  const std::vector<PlanarSlot> slots = Find(tees.Paint({0, 1, 3, 4}));

  ASSERT_EQ(slots.size(), 4U);
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(Has(slots, tees.Slot(i))) << i;
  const auto num_half_seen = std::count_if(slots.begin(), slots.end(), [](const PlanarSlot& slot) {
    return slot.num_marked_sides == 1;
  });
  EXPECT_EQ(num_half_seen, 2);
}

TEST(CornerMarks, AnglesInAllCornersGiveTheSameSlots) {
  const Tees row;
  std::vector<PaintLine> lines;
  for (int i = 0; i < 4; ++i)
    for (const double side : {0.0, 1.0})
      for (const double depth : {0.0, kDepth}) {
        const Vector2d corner = row.Corner(i) + side * row.pitch * row.Along() + depth * row.Into();
        const Vector2d into = depth > 0 ? Vector2d(-row.Into()) : row.Into();
        lines.push_back(Stroke(corner, corner + (side > 0 ? -0.8 : 0.8) * row.Along()));
        lines.push_back(Stroke(corner, corner + 0.8 * into));
      }
  const std::vector<PlanarSlot> slots = Find(lines);

  for (int i = 0; i < 4; ++i) EXPECT_TRUE(Has(slots, row.Slot(i))) << i;
  for (const PlanarSlot& slot : slots) {
    bool is_true = false;
    for (int i = 0; i < 4; ++i) is_true = is_true || OverlapOf(slot.corners, row.Slot(i)) > 0.95;
    EXPECT_TRUE(is_true);
  }
}

TEST(CornerMarks, BarsMayJoinToALine) {
  const Tees tees;
  std::vector<PaintLine> lines = tees.Paint({0, 1, 2, 3});
  std::erase_if(lines, [&](const PaintLine& line) {
    return std::abs(line.Direction().dot(tees.Along())) > 0.9;
  });
  lines.push_back(Stroke(tees.Corner(0), tees.Corner(3)));

  EXPECT_EQ(Find(lines).size(), 3U);
}

TEST(CornerMarks, SlotsMayStandApart) {
  const Tees left{.pitch = 6.3}, right{.start = left.Corner(0) - 0.4 * left.Along(), .pitch = 6.3};
  std::vector<PaintLine> lines = left.Paint({0, 1, 2, 3});
  for (const int i : {1, 2, 3}) right.Paint(i, lines);
  const std::vector<PlanarSlot> slots = Find(lines);

  ASSERT_GE(slots.size(), 3U);
  for (int i = 0; i < 3; ++i) {
    const auto covers = [&](const PlanarSlot& slot) {
      return OverlapOf(slot.corners, left.Slot(i, 2.0)) > 0.85;
    };
    EXPECT_TRUE(std::any_of(slots.begin(), slots.end(), covers)) << i;
  }
}

TEST(CornerMarks, RowsAcrossAnAisleAreTwo) {
  const Tees row,
      opposite{.start = Vector2d(3, -2) + 10.0 * Vector2d(std::cos(0.3), std::sin(0.3)) -
                        6.0 * Vector2d(-std::sin(0.3), std::cos(0.3)),
               .yaw = 0.3 + std::numbers::pi};
  std::vector<PaintLine> lines = row.Paint({0, 1, 2, 3});
  for (const int i : {0, 1, 2, 3}) opposite.Paint(i, lines);
  const std::vector<PlanarSlot> slots = Find(lines);

  ASSERT_EQ(slots.size(), 6U);
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(Has(slots, row.Slot(i)));
    EXPECT_TRUE(Has(slots, opposite.Slot(i)));
  }
}

TEST(CornerMarks, TwoAreNoRowNorAreThoseOfTwoDecks) {
  const Tees tees;
  EXPECT_TRUE(Find(tees.Paint({0, 1})).empty());
  std::vector<PaintLine> lines = tees.Paint({0, 1});
  const Tees above{.height = 2.8};
  above.Paint(2, lines);
  EXPECT_TRUE(Find(lines).empty());
}

TEST(CornerMarks, StemsWithoutBarsAndLongLinesAreNone) {
  const Tees tees;
  std::vector<PaintLine> stems, lined = tees.Paint({0, 1, 2, 3});
  for (const PaintLine& line : lined)
    if (std::abs(line.Direction().dot(tees.Into())) > 0.9) stems.push_back(line);
  EXPECT_TRUE(Find(stems).empty());
  for (PaintLine& line : lined)
    if (std::abs(line.Direction().dot(tees.Into())) > 0.9) line.end = line.begin + 5 * tees.Into();
  EXPECT_TRUE(Find(lined).empty()) << "whole lines are for FindSlotRows";
}

TEST(CornerMarks, EdgesOfCarsAndShadowsAreNoPaint) {
  std::vector<PaintLine> lines = Tees().Paint({0, 1, 2, 3});
  for (PaintLine& line : lines) line.is_one_sided = true;
  EXPECT_TRUE(Find(lines).empty());
}

TEST(CornerMarks, LaddersAndNarrowBaysAreNone) {
  for (const double spacing : {0.5, 0.7, 0.9, 1.0, 1.2, 1.5}) {
    const Tees rungs{.pitch = spacing};
    std::vector<PaintLine> lines;
    for (int i = 0; i * spacing < 12; ++i)
      lines.push_back(Stroke(rungs.Corner(i), rungs.Corner(i) + 1.5 * rungs.Into()));
    lines.push_back(Stroke(rungs.start, rungs.start + 12 * rungs.Along()));
    EXPECT_TRUE(Find(lines).empty()) << spacing;
  }
}

TEST(CornerMarks, ADrivewayBetweenRowsIsNone) {
  const Tees tees;
  const std::vector<PaintLine> lines = tees.Paint({0, 1, 2, 3, 6, 7, 8, 9});
  const std::vector<bool> is_used(lines.size());
  const auto is_bare = [&](const Vector2d& place, double) {
    return std::none_of(lines.begin(), lines.end(), [&](const PaintLine& line) {
      return (place - line.Middle()).norm() < 0.5;
    });
  };
  EXPECT_EQ(FindSlotsAtMarks(lines, is_used, kDepth, {}).size(), 8U) << "two marks may be hidden";
  EXPECT_EQ(FindSlotsAtMarks(lines, is_used, kDepth, {}, is_bare).size(), 6U);
}

TEST(CornerMarks, AnglesOfTwoRanksMakeNoSlotsAlongTheAisle) {
  const Tees row;
  std::vector<PaintLine> lines;
  for (int i = 0; i < 3; ++i)
    for (const double side : {0.0, 1.0})
      for (const double depth : {0.0, 1.0, 2.0})
        for (const double turned : {1.0, -1.0}) {
          if ((depth == 0 && turned < 0) || (depth == 2 && turned > 0)) continue;
          const Vector2d corner =
              row.Corner(i) + side * row.pitch * row.Along() + depth * kDepth * row.Into();
          lines.push_back(Stroke(corner, corner + (side > 0 ? -0.8 : 0.8) * row.Along()));
          lines.push_back(Stroke(corner, corner + 0.8 * turned * row.Into()));
        }
  for (const PlanarSlot& slot : Find(lines)) EXPECT_EQ(slot.kind, SlotKind::kPerpendicular);
}

TEST(CornerMarks, InSlotsOfWholeLinesTellNothing) {
  const Tees letters{.start = Tees().start + 1.2 * Tees().Along() + 1.5 * Tees().Into()};
  std::vector<PaintLine> lines = letters.Paint({0, 1, 2, 3});
  const Tees tees;
  for (int i = 0; i < 5; ++i)
    lines.push_back(Stroke(tees.Corner(i), tees.Corner(i) + 5 * tees.Into()));
  const std::vector<PlanarSlot> slots = FindSlotRows(lines);
  ASSERT_EQ(slots.size(), 4U);
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(Has(slots, tees.Slot(i, 5.0))) << i;
}

TEST(CornerMarks, OfALargeSiteTakeLittleTime) {
  std::vector<PaintLine> lines;
  for (int y = 0; y < 100; ++y) {
    const Tees row{.start = {0, 12.0 * y}, .yaw = 0};
    for (int i = 0; i < 100; ++i) row.Paint(i, lines);
  }
  EXPECT_EQ(Find(lines).size(), 9900U);
}

TEST(CornerMarks, StrokesAtRandomMakeHardlyARow) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(0, 60), length(0.6, 1.8);
  std::uniform_int_distribution<int> turned(0, 1);
  std::size_t count = 0;
  for (int round = 0; round < 20; ++round) {
    std::vector<PaintLine> lines;
    for (int i = 0; i < 150; ++i) {
      const Vector2d begin(place(random), place(random));
      const Vector2d way =
          turned(random) ? Vector2d(length(random), 0) : Vector2d(0, length(random));
      lines.push_back(Stroke(begin, begin + way));
    }
    count += Find(lines).size();
  }
  EXPECT_EQ(count, 0U);
}

TEST(CornerMarks, AreFoundAmongWholeLines) {
  const Tees tees;
  EXPECT_EQ(FindSlotRows(tees.Paint({0, 1, 2, 3, 4})).size(), 4U);
}

}  // namespace
}  // namespace parkade
