#include "mapping/evaluate_surface.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/parallel.h"
#include "mapping/height_raster.h"

namespace parkade {
namespace {

constexpr double kMergeGap = 0.1;          // [m] overlapping triangles of one sheet
constexpr double kMaxAccuracyError = 1.0;  // [m] a sample without truth nearby counts with this

double Percentile(const std::vector<double>& sorted, double percent) {
  if (sorted.empty()) return 0;
  return sorted[static_cast<size_t>(percent / 100 * static_cast<double>(sorted.size() - 1) + 0.5)];
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

/// Intersection over union of the rims of two rasters.
double BoundaryIou(const HeightRaster& truth, const HeightRaster& estimate, const SurfaceEvaluationOptions& options) {
  const std::vector<bool> truth_rim = truth.FindRim(options.boundary_width, options.max_height_gap);
  const std::vector<bool> estimate_rim = estimate.FindRim(options.boundary_width, options.max_height_gap);
  size_t both = 0;
  for (size_t i = 0; i < estimate_rim.size(); ++i) {
    if (!estimate_rim[i]) continue;
    const HeightRaster::Sample& sample = estimate.samples()[i];
    const int found = truth.Find(sample.x, sample.y, sample.height, options.max_height_gap);
    if (found >= 0 && truth_rim[static_cast<size_t>(found)]) ++both;
  }
  const auto count = [](const std::vector<bool>& rim) {
    return static_cast<size_t>(std::count(rim.begin(), rim.end(), true));
  };
  const size_t either = count(truth_rim) + count(estimate_rim) - both;
  return either == 0 ? 1 : static_cast<double>(both) / static_cast<double>(either);
}

}  // namespace

void SurfaceEvaluationOptions::Validate() const {
  Require(sample_spacing > 0 && max_height_gap > 0 && max_completeness_distance > 0 && boundary_width > 0 &&
              max_path_distance > 0,
          ErrorCode::kUsage, "the distances of the surface evaluation must be > 0 m");
}

SurfaceEvaluation EvaluateSurface(const TriangleMesh& truth, const TriangleMesh& estimate,
                                  const SurfaceEvaluationOptions& options, std::span<const Eigen::Vector3d> path) {
  options.Validate();
  Require(!truth.empty(), ErrorCode::kInvalidInput, "the true surface has no triangle");
  Require(!estimate.empty(), ErrorCode::kInvalidInput, "the estimated surface has no triangle");
  HeightRaster truth_raster(truth, options.sample_spacing, kMergeGap);
  HeightRaster estimate_raster(estimate, options.sample_spacing, kMergeGap);
  if (!path.empty()) {
    truth_raster.KeepNear(path, options.max_path_distance);
    estimate_raster.KeepNear(path, options.max_path_distance);
  }
  const auto& truth_samples = truth_raster.samples();
  const auto& estimate_samples = estimate_raster.samples();

  std::vector<double> differences;
  for (const HeightRaster::Sample& sample : estimate_samples) {
    const int found = truth_raster.Find(sample.x, sample.y, sample.height, options.max_height_gap);
    if (found >= 0) differences.push_back(sample.height - truth_samples[static_cast<size_t>(found)].height);
  }
  SurfaceEvaluation evaluation;
  CompareHeights(differences, evaluation);
  const std::vector<double> distances = ParallelMap(estimate_samples.size(), [&](size_t i) {
    return truth_raster.DistanceTo(estimate_samples[i], kMaxAccuracyError).value_or(kMaxAccuracyError);
  });
  evaluation.accuracy_rmse = RootMeanSquare(distances);
  const std::vector<char> is_found = ParallelMap(truth_samples.size(), [&](size_t i) {
    return static_cast<char>(
        estimate_raster.DistanceTo(truth_samples[i], options.max_completeness_distance).has_value());
  });
  const auto num_found = static_cast<size_t>(std::count(is_found.begin(), is_found.end(), 1));
  const double sample_area = options.sample_spacing * options.sample_spacing;
  evaluation.truth_area = sample_area * static_cast<double>(truth_samples.size());
  evaluation.estimate_area = sample_area * static_cast<double>(estimate_samples.size());
  evaluation.completeness_percent = Percent(num_found, truth_samples.size());
  evaluation.false_free_percent = Percent(estimate_samples.size() - differences.size(), estimate_samples.size());
  const size_t either = truth_samples.size() + estimate_samples.size() - differences.size();
  evaluation.iou = either == 0 ? 0 : static_cast<double>(differences.size()) / static_cast<double>(either);
  evaluation.boundary_iou = BoundaryIou(truth_raster, estimate_raster, options);
  return evaluation;
}

std::string ToText(const SurfaceEvaluation& e) {
  char text[1024];
  std::snprintf(text, sizeof text,
                "surface              %.1f m^2 of %.1f m^2\n"
                "height error         rmse %.4f m  bias %+.4f m  median %.4f m  p90 %.4f m  p95 %.4f m  max %.4f m\n"
                "accuracy             rmse %.4f m\n"
                "completeness         %.2f %%\n"
                "false free space     %.2f %%\n"
                "IoU                  %.4f\n"
                "boundary IoU         %.4f\n",
                e.estimate_area, e.truth_area, e.height_rmse, e.height_bias, e.height_median, e.height_p90,
                e.height_p95, e.height_max, e.accuracy_rmse, e.completeness_percent, e.false_free_percent, e.iou,
                e.boundary_iou);
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
          {"accuracy_rmse", e.accuracy_rmse},
          {"completeness_percent", e.completeness_percent},
          {"false_free_percent", e.false_free_percent},
          {"iou", e.iou},
          {"boundary_iou", e.boundary_iou}};
}

}  // namespace parkade
