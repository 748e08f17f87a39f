#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/ground_markings.h"
#include "mapping/ground/quadrilateral.h"

namespace parkade {

/// A slot as it really is.
struct TrueSlot {
  Quadrilateral corners;  ///< [m] in any order around
  double height = 0;      ///< [m]
  bool is_occupied = false;
};

/// A drive is not blamed for slots whose lines it never saw; one that it found nevertheless counts
/// as right.
struct SlotScope {
  /// Which of these points were seen as ground from near enough; none: all of them.
  std::function<std::vector<bool>(const std::vector<Eigen::Vector3d>& points)> find_seen = {};
};

struct SlotEvaluation {
  std::size_t num_true = 0;    ///< that count
  std::size_t num_missed = 0;  ///< of them
  std::size_t num_found = 0;
  std::size_t num_right = 0;  ///< found ones that are slots
  double recall_percent = 0, precision_percent = 0;
  double corner_median = 0, corner_rmse = 0, corner_p95 = 0;  ///< [m] horizontally, of right ones
  double overlap_mean = 0;           ///< intersection over union, of right ones
  std::size_t num_judged = 0;        ///< right ones that are said to be free or occupied
  std::size_t num_judged_right = 0;  ///< of them
  std::size_t num_false_free = 0;    ///< said to be free, occupied
  double occupancy_percent = 0;      ///< right of the judged
};

/// Compares slots with the true ones, each with the one that it overlaps most. `found` in the frame
/// of the truth; its occupancy is that of its last state that is not unseen.
SlotEvaluation EvaluateSlots(const std::vector<TrueSlot>& truth,
                             const std::vector<ParkingSlot>& found, const SlotScope& scope = {});

/// A few aligned lines for people.
std::string ToText(const SlotEvaluation& evaluation);

/// Every field under its own name.
nlohmann::json ToJson(const SlotEvaluation& evaluation);

}  // namespace parkade
