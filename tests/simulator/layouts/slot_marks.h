#pragma once

#include <string>

#include "tests/simulator/common/rectangle.h"
#include "tests/simulator/ground/ground_painter.h"

namespace parkade::simulator {

/// How slots are marked.
enum class SlotMarks {
  kUsual,    ///< lots: a line at each side; streets: nothing
  kTees,     ///< a T at each end of a slot's entrance, shared by neighbors
  kCorners,  ///< an angle in each corner
};

/// "usual", "tees", "corners". Throws Error{kUsage} for others.
SlotMarks SlotMarksOf(const std::string& name);

/// Paints tees or corners of a slot; nothing of kUsual.
/// \param into  unit, from the entrance into the slot, along one of its sides
void MarkSlot(const Rectangle& slot, const Eigen::Vector2d& into, SlotMarks marks,
              GroundPainter& painter);

}  // namespace parkade::simulator
