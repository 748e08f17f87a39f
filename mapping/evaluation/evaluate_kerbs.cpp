#include "mapping/evaluation/evaluate_kerbs.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "mapping/ground/square_index.h"

namespace parkade {
namespace {

constexpr double kMaxDistance =
    0.3;  // [m] from a true kerb, horizontally, at which a found one is right
constexpr double kMaxHeightGap = 1.0;  // [m] of decks above each other
constexpr double kReach = 8.0;         // [m] from the path to which true kerbs count
constexpr double kSpacing = 0.2;       // [m] along kerbs
using Eigen::Vector3d;

constexpr double kSquare = 2.0;    // [m] side of the squares that pieces are sorted into
constexpr double kInFront = 0.15;  // [m] before a kerb: ground that must have been seen

/// A point of a line and what it is a point of.
struct LinePoint {
  Vector3d place;
  std::size_t line = 0;
};

/// Points every `step` [m] from begin to end, in the middles of equal parts.
void Walk(const Vector3d& begin, const Vector3d& end, double step, std::size_t line,
          std::vector<LinePoint>& points) {
  const int count = std::max(1, static_cast<int>(std::lround((end - begin).norm() / step)));
  for (int i = 0; i < count; ++i)
    points.push_back({begin + (i + 0.5) / count * (end - begin), line});
}

/// Finds the nearest of many points.
class NearPoints {
 public:
  explicit NearPoints(const std::vector<LinePoint>& points) : points_(&points), squares_(kSquare) {
    for (std::size_t i = 0; i < points.size(); ++i) squares_.Add(points[i].place.head<2>(), i);
  }

  /// Horizontally within `distance` [m] and on the same deck.
  std::optional<std::size_t> Find(const Vector3d& place, double distance,
                                  double max_height_gap) const {
    std::optional<std::size_t> best;
    squares_.VisitAround(place.head<2>(), distance, [&](std::size_t i) {
      const Vector3d offset = (*points_)[i].place - place;
      if (offset.head<2>().norm() > distance || std::abs(offset.z()) > max_height_gap) return;
      distance = offset.head<2>().norm();
      best = i;
    });
    return best;
  }

 private:
  const std::vector<LinePoint>* points_;
  SquareIndex<std::size_t> squares_;
};

/// The points of true kerbs that count.
std::vector<bool> FindScope(const std::vector<TrueKerb>& truth,
                            const std::vector<LinePoint>& points, const KerbScope& scope) {
  std::vector<bool> counts(points.size(), true);
  for (std::size_t i = 0; i < points.size() && !scope.path.empty(); ++i)
    counts[i] = std::any_of(scope.path.begin(), scope.path.end(), [&](const Vector3d& place) {
      const Vector3d offset = place - points[i].place;
      return offset.head<2>().norm() <= kReach && std::abs(offset.z()) < 2 * kMaxHeightGap;
    });
  if (!scope.ground.find_seen) return counts;
  std::vector<Vector3d> in_front;
  for (const LinePoint& point : points) {
    const Vector3d along = truth[point.line].end - truth[point.line].begin;
    const Eigen::Vector2d left = Eigen::Vector2d(-along.y(), along.x()).normalized();
    in_front.emplace_back(point.place + kInFront * Vector3d(left.x(), left.y(), 0));
  }
  const std::vector<bool> is_seen = scope.ground.find_seen(in_front);
  for (std::size_t i = 0; i < points.size(); ++i) counts[i] = counts[i] && is_seen[i];
  return counts;
}

double Percent(double part, double whole) { return whole > 0 ? 100 * part / whole : 0; }

void Summarize(const std::vector<double>& errors, const std::vector<double>& in_sigmas,
               KerbEvaluation& evaluation) {
  if (errors.empty()) return;
  std::vector<double> sizes;
  const auto count = static_cast<double>(errors.size());
  for (std::size_t i = 0; i < errors.size(); ++i) {
    sizes.push_back(std::abs(errors[i]));
    evaluation.height_bias += errors[i] / count;
    evaluation.height_rmse += errors[i] * errors[i] / count;
    evaluation.height_normalized_rmse += in_sigmas[i] * in_sigmas[i] / count;
  }
  std::sort(sizes.begin(), sizes.end());
  evaluation.height_median = sizes[sizes.size() / 2];
  evaluation.height_p95 = sizes[static_cast<std::size_t>(0.95 * (count - 1))];
  evaluation.height_rmse = std::sqrt(evaluation.height_rmse);
  evaluation.height_normalized_rmse = std::sqrt(evaluation.height_normalized_rmse);
}

}  // namespace

KerbEvaluation EvaluateKerbs(const std::vector<TrueKerb>& truth, const std::vector<Kerb>& found,
                             const KerbScope& scope) {
  std::vector<LinePoint> true_points, found_points;
  for (std::size_t i = 0; i < truth.size(); ++i)
    Walk(truth[i].begin, truth[i].end, kSpacing, i, true_points);
  for (std::size_t i = 0; i < found.size(); ++i)
    for (std::size_t k = 1; k < found[i].points.size(); ++k)
      Walk(found[i].points[k - 1], found[i].points[k], kSpacing, i, found_points);
  const NearPoints near_truth(true_points), near_found(found_points);
  const double reach = kMaxDistance + 0.5 * kSpacing;  // between points of the other line

  KerbEvaluation evaluation;
  const std::vector<bool> counts = FindScope(truth, true_points, scope);
  for (std::size_t i = 0; i < true_points.size(); ++i) {
    if (!counts[i]) continue;
    evaluation.true_length += kSpacing;
    if (!near_found.Find(true_points[i].place, reach, kMaxHeightGap))
      evaluation.missed_length += kSpacing;
  }
  std::vector<double> errors, in_sigmas;
  for (const LinePoint& point : found_points) {
    evaluation.found_length += kSpacing;
    const auto nearest = near_truth.Find(point.place, reach, kMaxHeightGap);
    if (!nearest) continue;
    evaluation.right_length += kSpacing;
    const Kerb& kerb = found[point.line];
    errors.push_back(kerb.height - truth[true_points[*nearest].line].height);
    in_sigmas.push_back(kerb.height_sigma > 0 ? errors.back() / kerb.height_sigma : 0);
  }
  evaluation.recall_percent =
      Percent(evaluation.true_length - evaluation.missed_length, evaluation.true_length);
  evaluation.precision_percent = Percent(evaluation.right_length, evaluation.found_length);
  Summarize(errors, in_sigmas, evaluation);
  return evaluation;
}

std::string ToText(const KerbEvaluation& evaluation) {
  char text[512];
  std::snprintf(text, sizeof text,
                "kerbs\n"
                "  recall       %6.1f %%  of %.0f m that were near and seen\n"
                "  precision    %6.1f %%  of %.0f m found\n"
                "  height       %6.3f m median, %.3f m RMSE, %.3f m for 95 %%, %+.3f m on average\n"
                "  sigmas       %6.1f    RMSE of the height in its own sigmas\n",
                evaluation.recall_percent, evaluation.true_length, evaluation.precision_percent,
                evaluation.found_length, evaluation.height_median, evaluation.height_rmse,
                evaluation.height_p95, evaluation.height_bias, evaluation.height_normalized_rmse);
  return text;
}

nlohmann::json ToJson(const KerbEvaluation& evaluation) {
  return {{"true_length", evaluation.true_length},
          {"missed_length", evaluation.missed_length},
          {"found_length", evaluation.found_length},
          {"right_length", evaluation.right_length},
          {"recall_percent", evaluation.recall_percent},
          {"precision_percent", evaluation.precision_percent},
          {"height_median", evaluation.height_median},
          {"height_p95", evaluation.height_p95},
          {"height_bias", evaluation.height_bias},
          {"height_rmse", evaluation.height_rmse},
          {"height_normalised_rmse", evaluation.height_normalized_rmse}};
}

}  // namespace parkade
