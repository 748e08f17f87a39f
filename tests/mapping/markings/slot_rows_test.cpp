#include "mapping/markings/slot_rows.h"

#include <gtest/gtest.h>

#include <random>

#include "core/error.h"
#include "mapping/evaluation/evaluate_slots.h"
#include "mapping/ground/quadrilateral.h"

namespace parkade {
namespace {

using Eigen::Vector2d;

/// A row of painted lines along the direction `yaw`, lines turned by `slant` from square to it.
struct PaintedRow {
  double yaw = 0.4, slant = 0, pitch = 2.5, length = 5;
  Vector2d start = {3, -2};

  Vector2d Along() const { return {std::cos(yaw), std::sin(yaw)}; }
  Vector2d Inward() const { return {-std::sin(yaw + slant), std::cos(yaw + slant)}; }

  /// The line of an index; `from` and `to` of its length are seen.
  PaintLine Line(int index, double from = 0, double to = 1) const {
    const Vector2d foot = start + index * pitch * Along();
    PaintLine line;
    line.begin = foot + (from * length - (from == 0 ? 0.06 : 0)) * Inward();
    line.end = foot + (to * length + (to == 1 ? 0.06 : 0)) * Inward();
    line.width = 0.12;
    line.contrast = 0.4;
    line.is_begin_seen = from == 0, line.is_end_seen = to == 1;
    return line;
  }

  /// Whole lines, from the first on.
  std::vector<PaintLine> Lines(int count) const {
    std::vector<PaintLine> lines;
    for (int i = 0; i < count; ++i) lines.push_back(Line(i));
    return lines;
  }

  /// The rectangle between two lines.
  TrueSlot Slot(int index) const {
    const double shift = pitch * std::sin(std::abs(slant)), width = pitch * std::cos(slant);
    // The rectangle that both lines bound: from the foot of the one that begins later.
    const Vector2d first = start + index * pitch * Along(), across(Inward().y(), -Inward().x());
    const Vector2d corner = slant > 0 ? first : first + shift * Inward();
    const double depth = length - shift;
    return {{corner, corner + width * across, corner + width * across + depth * Inward(),
             corner + depth * Inward()},
            0};
  }

  std::vector<TrueSlot> Slots(int count) const {
    std::vector<TrueSlot> slots;
    for (int i = 0; i < count; ++i) slots.push_back(Slot(i));
    return slots;
  }
};

std::vector<ParkingSlot> Lifted(const std::vector<PlanarSlot>& planar) {
  std::vector<ParkingSlot> slots;
  for (const PlanarSlot& slot : planar) {
    ParkingSlot lifted;
    for (std::size_t i = 0; i < 4; ++i) lifted.corners[i] << slot.corners[i], slot.height;
    slots.push_back(lifted);
  }
  return slots;
}

/// Stripes 5.5 m apart and a dash between each two make a row at half that distance, but for the
/// ground beside the dashes.
TEST(SlotRows, AreNoneWhereTheirLinesWouldBeBareGround) {
  const PaintedRow row{.pitch = 2.75};
  std::vector<PaintLine> lines;
  for (int i = 0; i < 7; ++i) lines.push_back(i % 2 == 0 ? row.Line(i) : row.Line(i, 0, 0.25));
  for (int i = 1; i < 7; i += 2) lines[static_cast<std::size_t>(i)].is_end_seen = true;
  for (int i = 2; i < 7; i += 4) lines[static_cast<std::size_t>(i)] = row.Line(i, 0, 0.25);
  EXPECT_FALSE(FindSlotRows(lines).empty()) << "where parked cars may hide lines";
  EXPECT_TRUE(FindSlotRows(lines, {}, [](const Vector2d&, double) { return true; }).empty());
}

TEST(SlotRows, LackAWornLineOrTwo) {
  const PaintedRow row;
  std::vector<PaintLine> lines;
  for (int i = 0; i < 9; ++i)
    if (i != 3 && i != 6) lines.push_back(row.Line(i));
  EXPECT_EQ(FindSlotRows(lines, {}, [](const Vector2d&, double) { return true; }).size(), 8U);
}

TEST(SlotRows, OfWholeLinesAreFoundToTheCentimeter) {
  const PaintedRow row;
  const std::vector<PaintLine> lines = row.Lines(7);
  const std::vector<TrueSlot> truth = row.Slots(6);
  const std::vector<PlanarSlot> slots = FindSlotRows(lines);
  ASSERT_EQ(slots.size(), 6U);
  for (const PlanarSlot& slot : slots) {
    EXPECT_EQ(slot.kind, SlotKind::kPerpendicular);
    EXPECT_GT(slot.confidence, 0.9);
    EXPECT_EQ(slot.num_marked_sides, 2);
    EXPECT_GT(SignedArea(slot.corners), 12);
  }
  const SlotEvaluation evaluation = EvaluateSlots(truth, Lifted(slots));
  EXPECT_EQ(evaluation.num_right, 6U);
  EXPECT_LT(evaluation.corner_rmse, 0.01);
}

TEST(SlotRows, HiddenLinesFollowFromTheirNeighbors) {
  const PaintedRow row;
  std::vector<PaintLine> lines;
  for (int i = 0; i < 9; ++i) {
    if (i == 3 || i == 6 || i == 7) continue;          // beneath cars
    lines.push_back(row.Line(i, 0, i % 2 ? 0.3 : 1));  // cars hide the rear
  }
  const std::vector<TrueSlot> truth = row.Slots(8);
  const std::vector<PlanarSlot> slots = FindSlotRows(lines);
  const SlotEvaluation evaluation = EvaluateSlots(truth, Lifted(slots));
  EXPECT_EQ(evaluation.num_missed,
            1U);  // nothing is seen of either line of the one between 6 and 7
  EXPECT_EQ(evaluation.num_right, slots.size());
  EXPECT_LT(evaluation.corner_rmse, 0.03);
}

TEST(SlotRows, AskewToTheAisleAreAngled) {
  for (const double slant : {-0.5, -0.25, 0.25, 0.5}) {
    PaintedRow row;
    row.slant = slant, row.pitch = 2.8, row.length = 6;
    const std::vector<PaintLine> lines = row.Lines(7);
    const std::vector<TrueSlot> truth = row.Slots(6);
    const std::vector<PlanarSlot> slots = FindSlotRows(lines);
    ASSERT_EQ(slots.size(), 6U) << slant;
    for (const PlanarSlot& slot : slots) {
      EXPECT_EQ(slot.kind, SlotKind::kAngled);
      EXPECT_NEAR(slot.angle, M_PI / 2 - std::abs(slant), 0.02);
    }
    const SlotEvaluation evaluation = EvaluateSlots(truth, Lifted(slots));
    EXPECT_EQ(evaluation.num_right, 6U) << slant;
    EXPECT_LT(evaluation.corner_rmse, 0.07) << slant;
  }
}

TEST(SlotRows, LinesOfTwoSlotsAreTwoRowsBackToBack) {
  PaintedRow row;
  row.length = 10;
  const std::vector<PaintLine> lines = row.Lines(5);
  const std::vector<PlanarSlot> slots = FindSlotRows(lines);
  ASSERT_EQ(slots.size(), 8U);
  for (const PlanarSlot& slot : slots) EXPECT_NEAR(SignedArea(slot.corners), 12.5, 0.3);
}

TEST(SlotRows, ShortLinesFarApartBoundParallelSlots) {
  PaintedRow row;
  row.pitch = 6, row.length = 2.1;
  const std::vector<PaintLine> lines = row.Lines(5);
  const std::vector<PlanarSlot> slots = FindSlotRows(lines);
  ASSERT_EQ(slots.size(), 4U);
  for (const PlanarSlot& slot : slots) EXPECT_EQ(slot.kind, SlotKind::kParallel);
}

/// No ground is seen behind a kerb, so nobody sees that lines end there.
TEST(SlotRows, ParallelSlotsMayEndAtAKerb) {
  PaintedRow row;
  row.pitch = 6, row.length = 2.1;
  std::vector<PaintLine> lines = row.Lines(5);
  for (PaintLine& line : lines) line.is_end_seen = false;
  EXPECT_EQ(FindSlotRows(lines).size(), 4U);
  for (std::size_t i = 0; i < lines.size(); ++i)
    lines[i].end -= 0.25 * static_cast<double>(i) * row.Inward();
  EXPECT_TRUE(FindSlotRows(lines).empty()) << "their ends have nothing in common";
}

TEST(SlotRows, DecksDoNotMix) {
  const PaintedRow row;
  std::vector<PaintLine> lines;
  for (int i = 0; i < 6; ++i) {
    lines.push_back(row.Line(i));
    lines.back().height = i % 2 ? 3.0 : 0.0;
  }
  EXPECT_TRUE(FindSlotRows(lines).empty());  // those of one deck are two pitches apart
}

/// In front of parked cars only stubs are seen; those of slanted rows do not lie beside each other.
TEST(SlotRows, OfSlantedStubsAreFound) {
  for (const double slant : {-0.4, -0.2, 0.2, 0.4}) {
    PaintedRow row;
    row.slant = slant, row.pitch = 2.7;
    std::vector<PaintLine> lines;
    for (int i = 0; i < 6; ++i) lines.push_back(row.Line(i, 0, i % 2 ? 0.45 : 0.14));
    const std::vector<TrueSlot> truth = row.Slots(5);
    const SlotEvaluation evaluation = EvaluateSlots(truth, Lifted(FindSlotRows(lines)));
    EXPECT_EQ(evaluation.num_found, 5U) << slant;
    EXPECT_EQ(evaluation.num_right, 5U) << slant;
  }
}

/// Near ends are seen of all lines, far ones blurred and mostly too short: only with the slant of
/// the near ones do three of them agree.
TEST(SlotRows, HaveParallelEnds) {
  PaintedRow row;
  row.slant = 0.3, row.pitch = 2.7, row.length = 5.5;
  std::vector<PaintLine> lines;
  for (int i = 0; i < 8; ++i) {
    lines.push_back(row.Line(i));
    if (i % 3 != 0) lines.back().end -= (0.5 + 0.2 * i) * row.Inward();
  }
  const std::vector<TrueSlot> truth = row.Slots(7);
  const SlotEvaluation evaluation = EvaluateSlots(truth, Lifted(FindSlotRows(lines)));
  EXPECT_EQ(evaluation.num_right, 7U);
  EXPECT_LT(evaluation.corner_rmse, 0.03);
}

/// Of a second row, behind the aisle of the first one, three lines show where they begin, one goes
/// on beneath a stain, and two end where cars happen to stand square to the lines.
TEST(SlotRows, WithParallelLinesHaveOneSlant) {
  PaintedRow row;
  row.slant = 0.35, row.pitch = 2.7, row.length = 5.9;
  std::vector<PaintLine> lines = row.Lines(7);
  std::vector<TrueSlot> truth = row.Slots(6);
  row.start += 11 * row.Inward();
  const double square = row.pitch * std::sin(row.slant) / row.length;  // of a line's length
  for (const PaintLine& line : {row.Line(0, 0.3, 0.6), row.Line(1, -0.12, 0.7), row.Line(2, 0, 0.6),
                                row.Line(3, 0, 0.6 + square), row.Line(4, 0, 0.5)})
    lines.push_back(line);
  for (const std::size_t i : {9U, 10U}) lines[i].is_end_seen = true;
  for (const TrueSlot& slot : row.Slots(4)) truth.push_back(slot);
  const SlotEvaluation evaluation = EvaluateSlots(truth, Lifted(FindSlotRows(lines)));
  EXPECT_EQ(evaluation.num_right, 10U);
  EXPECT_LT(evaluation.corner_rmse, 0.07);
}

/// Behind the ends no ground is seen: what they have in common is a wall, what differs are parked
/// cars.
TEST(SlotRows, EndAtWalls) {
  PaintedRow row;
  row.length = 4.6;
  std::vector<PaintLine> lines, hidden;
  for (int i = 0; i < 7; ++i) {
    lines.push_back(row.Line(i, 0, i == 2 ? 0.7 : 1));
    lines.back().is_end_seen = false;
    hidden.push_back(row.Line(i, 0, 0.88 - 0.09 * (i * 3 % 7)));
  }
  const std::vector<TrueSlot> truth = row.Slots(6);
  const SlotEvaluation evaluation = EvaluateSlots(truth, Lifted(FindSlotRows(lines)));
  EXPECT_EQ(evaluation.num_right, 6U);
  EXPECT_LT(evaluation.corner_rmse, 0.02);

  const std::vector<PlanarSlot> slots = FindSlotRows(hidden);
  ASSERT_EQ(slots.size(), 6U);
  for (const PlanarSlot& slot : slots)
    EXPECT_NEAR(SignedArea(slot.corners), row.pitch * 5.0, 0.2) << "as is usual";
}

/// Between cars on both sides of every line no line has ground on both.
TEST(SlotRows, OfLinesWithOneUnseenSideNeedAgreeingEnds) {
  const PaintedRow row;
  std::vector<PaintLine> lines;
  for (int i = 0; i < 5; ++i) lines.push_back(row.Line(i, 0, i % 2 ? 0.3 : 0.9));
  for (PaintLine& line : lines) line.is_one_sided = true;
  EXPECT_EQ(FindSlotRows(lines).size(), 4U);

  std::vector<PaintLine> cars = lines;  // not parked in line
  for (int i = 0; i < 5; ++i) cars[static_cast<std::size_t>(i)].begin += i % 3 * 0.3 * row.Inward();
  EXPECT_TRUE(FindSlotRows(cars).empty());
  for (PaintLine& line : lines) line.width = 0.3;  // no paint
  EXPECT_TRUE(FindSlotRows(lines).empty());
}

/// A ramp's edges and the shaft of an arrow halfway between them.
TEST(SlotRows, AreNotBoundByLinesThatAreMuchLonger) {
  PaintedRow row;
  row.pitch = 2.2;
  std::vector<PaintLine> lines;
  for (int i = 0; i < 3; ++i) lines.push_back(row.Line(i, 0, i == 1 ? 0.6 : 4));
  EXPECT_TRUE(FindSlotRows(lines).empty());
}

TEST(SlotRows, AreNotFoundInDisorder) {
  std::mt19937 random(5);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() % 10000) / 10000;
  };
  std::vector<PaintLine> lines;
  for (int i = 0; i < 60; ++i) {
    PaintLine line;
    line.begin = {uniform(-25, 25), uniform(-25, 25)};
    const double angle = uniform(0, 2 * M_PI), length = uniform(0.6, 4);
    line.end = line.begin + length * Vector2d(std::cos(angle), std::sin(angle));
    line.width = 0.12;
    line.is_begin_seen = line.is_end_seen = true;
    lines.push_back(line);
  }
  EXPECT_LE(FindSlotRows(lines).size(), 1U);
  EXPECT_TRUE(FindSlotRows({}).empty());
}

TEST(SlotRows, RefuseOptionsThatMakeNoSense) {
  SlotRowOptions options;
  options.beside.max_pitch = 1;
  EXPECT_THROW(FindSlotRows({}, options), Error);
}

TEST(Quadrilateral, SharesAreaWithItsNeighbors) {
  const Quadrilateral a = {Vector2d(0, 0), {4, 0}, {4, 2}, {0, 2}},
                      b = {Vector2d(3, 1), {6, 1}, {6, 5}, {3, 5}};
  EXPECT_DOUBLE_EQ(SignedArea(a), 8);
  EXPECT_DOUBLE_EQ(SharedArea(a, b), 1);
  EXPECT_DOUBLE_EQ(SharedArea(a, a), 8);
  EXPECT_DOUBLE_EQ(SharedArea(a, {Vector2d(9, 9), {10, 9}, {10, 10}, {9, 10}}), 0);
  EXPECT_TRUE(Contains(a, {1, 1}, 0.9));
  EXPECT_FALSE(Contains(a, {1, 1}, 1.1));
}

}  // namespace
}  // namespace parkade
