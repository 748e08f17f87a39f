#include "mapping/evaluation/evaluate_slots.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Five meters by two and a half, its entrance's first corner at (x, 0).
TrueSlot TrueAt(double x, bool is_occupied = false) {
  return {{Vector2d(x, 0), {x + 2.5, 0}, {x + 2.5, 5}, {x, 5}}, 0, is_occupied};
}

ParkingSlot FoundAt(double x, SlotState state = SlotState::kUnseen) {
  ParkingSlot slot;
  slot.corners = {Vector3d(x, 0, 0), {x + 2.5, 0, 0}, {x + 2.5, 5, 0}, {x, 5, 0}};
  slot.states = {state};
  return slot;
}

TEST(EvaluateSlots, CountsWhatIsFoundMissedAndFalse) {
  const SlotEvaluation evaluation = EvaluateSlots({TrueAt(0), TrueAt(2.5), TrueAt(5), TrueAt(7.5)},
                                                  {FoundAt(0.1), FoundAt(2.5), FoundAt(20)});
  EXPECT_EQ(evaluation.num_true, 4U);
  EXPECT_EQ(evaluation.num_missed, 2U);
  EXPECT_EQ(evaluation.num_right, 2U);
  EXPECT_DOUBLE_EQ(evaluation.recall_percent, 50);
  EXPECT_NEAR(evaluation.precision_percent, 66.67, 0.01);
  EXPECT_NEAR(evaluation.corner_rmse, 0.1 / std::sqrt(2.0), 1e-9);
}

TEST(EvaluateSlots, OneSlotIsFoundOnceAndOnlyOnItsDeck) {
  EXPECT_EQ(EvaluateSlots({TrueAt(0)}, {FoundAt(0), FoundAt(0.1)}).num_right, 1U);
  TrueSlot above = TrueAt(0);
  above.height = 3;
  EXPECT_EQ(EvaluateSlots({above}, {FoundAt(0)}).num_right, 0U);
}

TEST(EvaluateSlots, SlotsWhoseLinesWereNotSeenDoNotCount) {
  // Of the second slot one line only, of the third half a meter of the other.
  const SlotScope scope{[](const std::vector<Vector3d>& points) {
    std::vector<bool> is_seen;
    for (const Vector3d& point : points)
      is_seen.push_back(point.x() < 4 || (point.x() < 7 && point.y() < 0.5));
    return is_seen;
  }};
  const std::vector<TrueSlot> truth = {TrueAt(0), TrueAt(2.5), TrueAt(5)};
  EXPECT_EQ(EvaluateSlots(truth, {}, scope).num_true, 1U);
  const SlotEvaluation evaluation = EvaluateSlots(truth, {FoundAt(2.5)}, scope);
  EXPECT_EQ(evaluation.num_right, 1U);  // found nevertheless
  EXPECT_EQ(evaluation.num_missed, 1U);
}

TEST(EvaluateSlots, JudgesOccupancyWhereItIsKnown) {
  const SlotEvaluation evaluation =
      EvaluateSlots({TrueAt(0, true), TrueAt(2.5, true), TrueAt(5), TrueAt(7.5)},
                    {FoundAt(0, SlotState::kOccupied), FoundAt(2.5, SlotState::kFree),
                     FoundAt(5, SlotState::kFree), FoundAt(7.5, SlotState::kUnseen)});
  EXPECT_EQ(evaluation.num_judged, 3U);
  EXPECT_EQ(evaluation.num_judged_right, 2U);
  EXPECT_EQ(evaluation.num_false_free, 1U);
  EXPECT_NE(ToText(evaluation).find("recall"), std::string::npos);
}

}  // namespace
}  // namespace parkade
