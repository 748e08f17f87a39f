#include "tests/simulator/layouts/slot_marks.h"

#include <cmath>

#include "core/error.h"

namespace parkade::simulator {

using Eigen::Vector2d;

SlotMarks SlotMarksOf(const std::string& name) {
  if (name == "usual") return SlotMarks::kUsual;
  if (name == "tees") return SlotMarks::kTees;
  Require(name == "corners", ErrorCode::kUsage, "slot_marks must be usual, tees or corners");
  return SlotMarks::kCorners;
}

void MarkSlot(const Rectangle& slot, const Vector2d& into, SlotMarks marks,
              GroundPainter& painter) {
  if (marks == SlotMarks::kUsual) return;
  constexpr double kWidth = 0.11, kStem = 0.9, kHalfBar = 0.45;  // [m]
  const Vector2d x(std::cos(slot.yaw), std::sin(slot.yaw)), across(-into.y(), into.x());
  const bool is_along_x = std::abs(into.dot(x)) > 0.5;
  const double half_depth = is_along_x ? slot.half_size.x() : slot.half_size.y(),
               half_width = is_along_x ? slot.half_size.y() : slot.half_size.x();
  const float wear = static_cast<float>(painter.random().Uniform(0.15, 0.5));
  for (const double side : {-1.0, 1.0}) {
    const Vector2d corner = slot.center - half_depth * into + side * half_width * across;
    painter.Line(corner, corner + kStem * into, kWidth, wear);
    if (marks == SlotMarks::kTees) {
      painter.Line(corner - kHalfBar * across, corner + kHalfBar * across, kWidth, wear);
      continue;
    }
    painter.Line(corner, corner - side * kStem * across, kWidth, wear);
    const Vector2d behind = corner + 2 * half_depth * into;
    painter.Line(behind, behind - kStem * into, kWidth, wear);
    painter.Line(behind, behind - side * kStem * across, kWidth, wear);
  }
}

}  // namespace parkade::simulator
