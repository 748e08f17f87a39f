#include "mapping/evaluation/evaluate_slots.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace parkade {
namespace {

constexpr double kMinOverlap = 0.5;    // intersection over union from which a slot is found
constexpr double kMaxHeightGap = 1.0;  // [m] of slots above each other that are not the same
constexpr double kSeenLength =
    1.0;  // [m] of each line beside a slot that a camera must have seen for it to count
constexpr double kStep = 0.1;  // [m] between points of a line that may be seen

Quadrilateral CounterClockwise(Quadrilateral shape) {
  if (SignedArea(shape) < 0) std::reverse(shape.begin(), shape.end());
  return shape;
}

Quadrilateral OutlineOf(const ParkingSlot& slot) {
  Quadrilateral shape;
  for (std::size_t i = 0; i < 4; ++i) shape[i] = slot.corners[i].head<2>();
  return CounterClockwise(shape);
}

/// The points of both long sides of a slot, one side after the other.
std::array<std::vector<Eigen::Vector3d>, 2> LinesOf(const TrueSlot& slot) {
  const bool is_first_long =
      (slot.corners[1] - slot.corners[0]).norm() > (slot.corners[2] - slot.corners[1]).norm();
  std::array<std::vector<Eigen::Vector3d>, 2> lines;
  for (std::size_t side = 0; side < 2; ++side) {
    const std::size_t first = 2 * side + (is_first_long ? 0 : 1);
    const Eigen::Vector2d begin = slot.corners[first], end = slot.corners[(first + 1) % 4];
    const int count = std::max(1, static_cast<int>((end - begin).norm() / kStep));
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector2d point = begin + (i + 0.5) / count * (end - begin);
      lines[side].emplace_back(point.x(), point.y(), slot.height);
    }
  }
  return lines;
}

/// The slots of which enough was seen of both lines.
std::vector<bool> FindScope(const std::vector<TrueSlot>& truth, const SlotScope& scope) {
  std::vector<bool> counts(truth.size(), true);
  if (!scope.find_seen) return counts;
  std::vector<Eigen::Vector3d> points;
  std::vector<std::pair<std::size_t, std::size_t>> ranges;  // two for each slot
  for (const TrueSlot& slot : truth)
    for (const std::vector<Eigen::Vector3d>& line : LinesOf(slot)) {
      ranges.emplace_back(points.size(), points.size() + line.size());
      points.insert(points.end(), line.begin(), line.end());
    }
  const std::vector<bool> is_seen = scope.find_seen(points);
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const auto begin = is_seen.begin() + static_cast<std::ptrdiff_t>(ranges[i].first);
    const auto end = is_seen.begin() + static_cast<std::ptrdiff_t>(ranges[i].second);
    if (kStep * static_cast<double>(std::count(begin, end, true)) < kSeenLength)
      counts[i / 2] = false;
  }
  return counts;
}

SlotState LastState(const ParkingSlot& slot) {
  for (auto state = slot.states.rbegin(); state != slot.states.rend(); ++state)
    if (*state != SlotState::kUnseen) return *state;
  return SlotState::kUnseen;
}

/// [m] from each corner to the other slot's corner that is nearest to it.
void AddCornerErrors(const Quadrilateral& found, const Quadrilateral& truth,
                     std::vector<double>& errors) {
  for (const Eigen::Vector2d& corner : found) {
    double nearest = 1e9;
    for (const Eigen::Vector2d& other : truth) nearest = std::min(nearest, (corner - other).norm());
    errors.push_back(nearest);
  }
}

void AddOccupancy(const ParkingSlot& found, const TrueSlot& truth, SlotEvaluation& evaluation) {
  const SlotState state = LastState(found);
  if (state == SlotState::kUnseen) return;
  ++evaluation.num_judged;
  evaluation.num_judged_right += (state == SlotState::kOccupied) == truth.is_occupied;
  evaluation.num_false_free += state == SlotState::kFree && truth.is_occupied;
}

double Percent(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0 : 100 * static_cast<double>(part) / static_cast<double>(whole);
}

void Summarize(std::vector<double> errors, SlotEvaluation& evaluation) {
  if (errors.empty()) return;
  std::sort(errors.begin(), errors.end());
  const auto at = [&](double share) {
    return errors[static_cast<std::size_t>(share * static_cast<double>(errors.size() - 1))];
  };
  double squares = 0;
  for (const double error : errors) squares += error * error;
  evaluation.corner_median = at(0.5);
  evaluation.corner_p95 = at(0.95);
  evaluation.corner_rmse = std::sqrt(squares / static_cast<double>(errors.size()));
}

}  // namespace

SlotEvaluation EvaluateSlots(const std::vector<TrueSlot>& truth,
                             const std::vector<ParkingSlot>& found, const SlotScope& scope) {
  const std::vector<bool> counts = FindScope(truth, scope);
  std::vector<Quadrilateral> outlines;
  for (const TrueSlot& slot : truth) outlines.push_back(CounterClockwise(slot.corners));
  std::vector<bool> is_hit(truth.size());
  std::vector<double> errors;
  SlotEvaluation evaluation;
  evaluation.num_found = found.size();
  for (const ParkingSlot& slot : found) {
    const Quadrilateral outline = OutlineOf(slot);
    std::size_t best = truth.size();
    double best_overlap = kMinOverlap;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      if (is_hit[i] || std::abs(truth[i].height - slot.Center().z()) > kMaxHeightGap) continue;
      const double overlap = OverlapOf(outline, outlines[i]);
      if (overlap >= best_overlap) best = i, best_overlap = overlap;
    }
    if (best == truth.size()) continue;
    is_hit[best] = true;
    ++evaluation.num_right;
    evaluation.overlap_mean += best_overlap;
    AddCornerErrors(outline, outlines[best], errors);
    AddOccupancy(slot, truth[best], evaluation);
  }
  for (std::size_t i = 0; i < truth.size(); ++i) {
    evaluation.num_true += counts[i];
    evaluation.num_missed += counts[i] && !is_hit[i];
  }
  if (evaluation.num_right > 0)
    evaluation.overlap_mean /= static_cast<double>(evaluation.num_right);
  evaluation.recall_percent =
      Percent(evaluation.num_true - evaluation.num_missed, evaluation.num_true);
  evaluation.precision_percent = Percent(evaluation.num_right, evaluation.num_found);
  evaluation.occupancy_percent = Percent(evaluation.num_judged_right, evaluation.num_judged);
  Summarize(std::move(errors), evaluation);
  return evaluation;
}

std::string ToText(const SlotEvaluation& evaluation) {
  char text[512];
  std::snprintf(text, sizeof text,
                "slots\n"
                "  recall       %6.1f %%  of %zu whose lines were seen\n"
                "  precision    %6.1f %%  of %zu found\n"
                "  corners      %6.3f m median, %.3f m RMSE, %.3f m for 95 %%\n"
                "  overlap      %6.3f    intersection over union, mean\n"
                "  occupancy    %6.1f %%  right of %zu judged; %zu occupied ones called free\n",
                evaluation.recall_percent, evaluation.num_true, evaluation.precision_percent,
                evaluation.num_found, evaluation.corner_median, evaluation.corner_rmse,
                evaluation.corner_p95, evaluation.overlap_mean, evaluation.occupancy_percent,
                evaluation.num_judged, evaluation.num_false_free);
  return text;
}

nlohmann::json ToJson(const SlotEvaluation& evaluation) {
  return {{"num_true", evaluation.num_true},
          {"num_missed", evaluation.num_missed},
          {"num_found", evaluation.num_found},
          {"num_right", evaluation.num_right},
          {"recall_percent", evaluation.recall_percent},
          {"precision_percent", evaluation.precision_percent},
          {"corner_median", evaluation.corner_median},
          {"corner_rmse", evaluation.corner_rmse},
          {"corner_p95", evaluation.corner_p95},
          {"overlap_mean", evaluation.overlap_mean},
          {"num_judged", evaluation.num_judged},
          {"num_judged_right", evaluation.num_judged_right},
          {"num_false_free", evaluation.num_false_free},
          {"occupancy_percent", evaluation.occupancy_percent}};
}

}  // namespace parkade
