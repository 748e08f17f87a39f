#include "mapping/evaluation/evaluate_surface.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/parallel.h"
#include "mapping/evaluation/height_calibration.h"

namespace parkade {
namespace {

constexpr double kMaxAccuracyError = 1.0;  // [m] a sample without truth nearby counts with this
constexpr double kRampSlope = 0.05;
constexpr double kSlopeReach = 0.5;  // [m] to each side, over which a slope is measured

double Percentile(const std::vector<double>& sorted, double percent) {
  if (sorted.empty()) return 0;
  return sorted[static_cast<size_t>(
      std::lround(percent / 100 * static_cast<double>(sorted.size() - 1)))];
}

double RootMeanSquare(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return values.empty() ? 0 : std::sqrt(sum / static_cast<double>(values.size()));
}

double Percent(size_t part, size_t whole) {
  return whole == 0 ? 0 : 100 * static_cast<double>(part) / static_cast<double>(whole);
}

void CompareHeights(const std::vector<double>& differences, SurfaceEvaluation& evaluation) {
  evaluation.num_samples = differences.size();
  evaluation.height_rmse = RootMeanSquare(differences);
  std::vector<double> sorted;
  for (const double difference : differences) {
    evaluation.height_bias += difference / static_cast<double>(differences.size());
    sorted.push_back(std::abs(difference));
  }
  std::sort(sorted.begin(), sorted.end());
  evaluation.height_median = Percentile(sorted, 50);
  evaluation.height_p90 = Percentile(sorted, 90);
  evaluation.height_p95 = Percentile(sorted, 95);
  evaluation.height_max = Percentile(sorted, 100);
}

size_t Count(const std::vector<bool>& flags) {
  return static_cast<size_t>(std::count(flags.begin(), flags.end(), true));
}

/// Intersection over union of the rims of two surfaces.
double BoundaryIou(const ScopedSurfaces& surfaces, double width,
                   const SurfaceEvaluationOptions& options) {
  const auto& [truth, estimate, path] = surfaces;
  const Rims rims = FindRims(surfaces, width, options);
  size_t both = 0;
  for (size_t i = 0; i < rims.of_estimate.size(); ++i) {
    if (!rims.of_estimate[i]) continue;
    const int found = truth.Find(estimate.samples()[i], options.max_height_gap);
    if (found >= 0 && rims.of_truth[static_cast<size_t>(found)]) ++both;
  }
  const size_t either = Count(rims.of_truth) + Count(rims.of_estimate) - both;
  return either == 0 ? 1 : static_cast<double>(both) / static_cast<double>(either);
}

/// [m] of the rim that B. Cheng et al. compare by default: 2 % of the diagonal of what the truth in
/// the scope spans.
double RelativeWidth(const ScopedRaster& truth, const SurfaceEvaluationOptions& options) {
  constexpr double kShare = 0.02;
  Eigen::Array2i low = Eigen::Array2i::Constant(INT_MAX), high = Eigen::Array2i::Constant(INT_MIN);
  for (size_t i = 0; i < truth.samples().size(); ++i) {
    if (!truth.counts[i]) continue;
    const Eigen::Array2i place(truth.samples()[i].x, truth.samples()[i].y);
    low = low.min(place);
    high = high.max(place + 1);
  }
  const Eigen::Array2d span =
      (high.cast<double>() - low.cast<double>()).max(0) * options.sample_spacing;
  return std::max(kShare * span.matrix().norm(), options.sample_spacing);
}

/// Whether the true surface climbs by more than kRampSlope around one of its samples.
bool IsRamp(const HeightRaster& truth, const HeightRaster::Sample& sample,
            const SurfaceEvaluationOptions& options) {
  const int reach = static_cast<int>(std::ceil(kSlopeReach / options.sample_spacing));
  const auto slope = [&](int dx, int dy) {
    const int a = truth.Find(sample.x - dx, sample.y - dy, sample.height, options.max_height_gap);
    const int b = truth.Find(sample.x + dx, sample.y + dy, sample.height, options.max_height_gap);
    if (a < 0 || b < 0) return 0.0;
    const auto& samples = truth.samples();
    return (samples[static_cast<size_t>(b)].height - samples[static_cast<size_t>(a)].height) /
           (2 * reach * options.sample_spacing);
  };
  return std::hypot(slope(reach, 0), slope(0, reach)) > kRampSlope;
}

/// Heights where both are.
void CompareCommonGround(const ScopedRaster& truth, const ScopedRaster& estimate,
                         const SurfaceEvaluationOptions& options, SurfaceEvaluation& evaluation) {
  std::vector<double> differences, on_ramps;
  for (size_t i = 0; i < estimate.samples().size(); ++i) {
    if (!estimate.counts[i]) continue;
    const HeightRaster::Sample& sample = estimate.samples()[i];
    const int found = truth.Find(sample, options.max_height_gap);
    if (found < 0) continue;
    const HeightRaster::Sample& true_sample = truth.samples()[static_cast<size_t>(found)];
    differences.push_back(sample.height - true_sample.height);
    if (IsRamp(truth.raster, true_sample, options)) on_ramps.push_back(differences.back());
  }
  CompareHeights(differences, evaluation);
  evaluation.ramp_area =
      options.sample_spacing * options.sample_spacing * static_cast<double>(on_ramps.size());
  evaluation.ramp_height_rmse = RootMeanSquare(on_ramps);
}

/// [m] of the true ground at a point of the estimate that counts.
std::optional<double> TrueHeight(const ScopedRaster& truth, const ScopedRaster& estimate,
                                 const Eigen::Vector3d& point,
                                 const SurfaceEvaluationOptions& options) {
  const HeightRaster::Sample at{static_cast<int>(std::floor(point.x() / options.sample_spacing)),
                                static_cast<int>(std::floor(point.y() / options.sample_spacing)),
                                point.z()};
  const int own = estimate.Find(at, options.max_height_gap);
  if (own < 0 || !estimate.counts[static_cast<size_t>(own)]) return {};
  const int found = truth.Find(at, options.max_height_gap);
  if (found < 0) return {};
  return truth.samples()[static_cast<size_t>(found)].height;
}

}  // namespace

SurfaceEvaluation EvaluateSurface(const TriangleMesh& truth_mesh, const TriangleMesh& estimate_mesh,
                                  const SurfaceEvaluationOptions& options,
                                  const SurfaceScope& scope) {
  return EvaluateSurface(ScopeSurfaces(truth_mesh, estimate_mesh, options, scope), estimate_mesh,
                         options);
}

SurfaceEvaluation EvaluateSurface(const ScopedSurfaces& surfaces, const TriangleMesh& estimate_mesh,
                                  const SurfaceEvaluationOptions& options) {
  const ScopedRaster &truth = surfaces.truth, &estimate = surfaces.estimate;
  SurfaceEvaluation evaluation;
  CompareCommonGround(truth, estimate, options, evaluation);
  evaluation.beyond_two_sigmas_percent = PercentBeyondTwoSigmas(
      estimate_mesh,
      [&](const Eigen::Vector3d& point) { return TrueHeight(truth, estimate, point, options); });
  // What is there and was never seen cannot be false, but counts as part of the estimate.
  const size_t num_false = Count(estimate.counts) - evaluation.num_samples;
  const std::vector<double> distances = ParallelMap(estimate.samples().size(), [&](size_t i) {
    if (!estimate.counts[i]) return -1.0;
    return truth.raster.DistanceTo(estimate.samples()[i], kMaxAccuracyError)
        .value_or(kMaxAccuracyError);
  });
  std::vector<double> counted;
  std::copy_if(distances.begin(), distances.end(), std::back_inserter(counted),
               [](double d) { return d >= 0; });
  evaluation.accuracy_rmse = RootMeanSquare(counted);
  const std::vector<char> is_found = ParallelMap(truth.samples().size(), [&](size_t i) {
    return static_cast<char>(
        truth.counts[i] &&
        estimate.raster.DistanceTo(truth.samples()[i], options.max_completeness_distance)
            .has_value());
  });
  const auto num_found = static_cast<size_t>(std::count(is_found.begin(), is_found.end(), 1));
  const size_t num_true = Count(truth.counts);
  const double sample_area = options.sample_spacing * options.sample_spacing;
  evaluation.truth_area = sample_area * static_cast<double>(num_true);
  evaluation.estimate_area = sample_area * static_cast<double>(estimate.num_in_scope);
  evaluation.completeness_percent = Percent(num_found, num_true);
  evaluation.false_free_percent = Percent(num_false, estimate.num_in_scope);
  const size_t either = num_true + num_false;
  evaluation.iou =
      either == 0 ? 0 : static_cast<double>(evaluation.num_samples) / static_cast<double>(either);
  evaluation.boundary_iou = BoundaryIou(surfaces, options.boundary_width, options);
  evaluation.relative_boundary_width = RelativeWidth(truth, options);
  evaluation.relative_boundary_iou =
      BoundaryIou(surfaces, evaluation.relative_boundary_width, options);
  return evaluation;
}

std::string ToText(const SurfaceEvaluation& e) {
  char text[1024];
  std::snprintf(text, sizeof text,
                "surface              %.1f m^2 of %.1f m^2\n"
                "height error         rmse %.4f m  bias %+.4f m  median %.4f m  p90 %.4f m  p95 "
                "%.4f m  max %.4f m\n"
                "height sigmas        %.1f %% of the area off by more than two\n"
                "accuracy             rmse %.4f m\n"
                "completeness         %.2f %%\n"
                "false free space     %.2f %%\n"
                "IoU                  %.4f\n"
                "boundary IoU         %.4f  %.4f over 2 %% of the diagonal, %.2f m\n"
                "ramps                rmse %.4f m on %.1f m^2\n",
                e.estimate_area, e.truth_area, e.height_rmse, e.height_bias, e.height_median,
                e.height_p90, e.height_p95, e.height_max, e.beyond_two_sigmas_percent,
                e.accuracy_rmse, e.completeness_percent, e.false_free_percent, e.iou,
                e.boundary_iou, e.relative_boundary_iou, e.relative_boundary_width,
                e.ramp_height_rmse, e.ramp_area);
  return text;
}

nlohmann::json ToJson(const SurfaceEvaluation& e) {
  return {{"num_samples", e.num_samples},
          {"truth_area", e.truth_area},
          {"estimate_area", e.estimate_area},
          {"height_rmse", e.height_rmse},
          {"height_bias", e.height_bias},
          {"height_median", e.height_median},
          {"height_p90", e.height_p90},
          {"height_p95", e.height_p95},
          {"height_max", e.height_max},
          {"beyond_two_sigmas_percent", e.beyond_two_sigmas_percent},
          {"accuracy_rmse", e.accuracy_rmse},
          {"completeness_percent", e.completeness_percent},
          {"false_free_percent", e.false_free_percent},
          {"iou", e.iou},
          {"boundary_iou", e.boundary_iou},
          {"relative_boundary_iou", e.relative_boundary_iou},
          {"relative_boundary_width", e.relative_boundary_width},
          {"ramp_area", e.ramp_area},
          {"ramp_height_rmse", e.ramp_height_rmse}};
}

}  // namespace parkade
