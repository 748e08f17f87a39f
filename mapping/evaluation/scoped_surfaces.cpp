#include "mapping/evaluation/scoped_surfaces.h"

#include <algorithm>

#include "core/error.h"

namespace parkade {
namespace {

constexpr double kMergeGap = 0.1;  // [m] overlapping triangles of one sheet

ScopedRaster NearPath(const TriangleMesh& mesh, const SurfaceScope& scope,
                      const SurfaceEvaluationOptions& options) {
  ScopedRaster scoped{HeightRaster(mesh, options.sample_spacing, kMergeGap), {}, {}, 0};
  scoped.counts = scope.path.empty()
                      ? std::vector<bool>(scoped.samples().size(), true)
                      : scoped.raster.FindNear(scope.path, options.max_path_distance);
  scoped.num_in_scope =
      static_cast<size_t>(std::count(scoped.counts.begin(), scoped.counts.end(), true));
  return scoped;
}

/// Leaves unseen truth out, and what was guessed there.
void LeaveOutUnseen(const SurfaceScope& scope, const SurfaceEvaluationOptions& options,
                    ScopedRaster& truth, ScopedRaster& estimate) {
  std::vector<Eigen::Vector3d> points;
  std::vector<size_t> sample_of;
  for (size_t i = 0; i < truth.samples().size(); ++i)
    if (truth.counts[i]) {
      points.push_back(truth.raster.PointOf(truth.samples()[i]));
      sample_of.push_back(i);
    }
  const std::vector<bool> is_seen = scope.find_seen(points);
  truth.is_unseen.assign(truth.samples().size(), false);
  for (size_t k = 0; k < sample_of.size(); ++k) truth.is_unseen[sample_of[k]] = !is_seen[k];
  for (size_t i = 0; i < truth.samples().size(); ++i)
    if (truth.is_unseen[i]) truth.counts[i] = false;
  for (size_t i = 0; i < estimate.samples().size(); ++i) {
    const int found = truth.Find(estimate.samples()[i], options.max_height_gap);
    if (found >= 0 && truth.is_unseen[static_cast<size_t>(found)]) estimate.counts[i] = false;
  }
}

std::vector<bool> RimOf(const ScopedRaster& scoped, std::span<const Eigen::Vector3d> path,
                        double width, const SurfaceEvaluationOptions& options) {
  std::vector<bool> is_rim = scoped.raster.FindRim(width, options.max_height_gap);
  const std::vector<bool> is_inside =
      path.empty() ? scoped.counts
                   : scoped.raster.FindNear(path, options.max_path_distance - width);
  for (size_t i = 0; i < is_rim.size(); ++i)
    is_rim[i] = is_rim[i] && scoped.counts[i] && is_inside[i];
  return is_rim;
}

}  // namespace

void SurfaceEvaluationOptions::Validate() const {
  Require(sample_spacing > 0 && max_height_gap > 0 && max_completeness_distance > 0 &&
              boundary_width > 0 && max_path_distance > 0,
          ErrorCode::kUsage, "the distances of the surface evaluation must be > 0 m");
}

ScopedSurfaces ScopeSurfaces(const TriangleMesh& truth, const TriangleMesh& estimate,
                             const SurfaceEvaluationOptions& options, const SurfaceScope& scope) {
  options.Validate();
  Require(!truth.empty(), ErrorCode::kInvalidInput, "the true surface has no triangle");
  Require(!estimate.empty(), ErrorCode::kInvalidInput, "the estimated surface has no triangle");
  ScopedSurfaces surfaces{NearPath(truth, scope, options),
                          NearPath(estimate, scope, options),
                          {scope.path.begin(), scope.path.end()}};
  if (scope.find_seen) LeaveOutUnseen(scope, options, surfaces.truth, surfaces.estimate);
  return surfaces;
}

Rims FindRims(const ScopedSurfaces& surfaces, double width,
              const SurfaceEvaluationOptions& options) {
  const auto& [truth, estimate, path] = surfaces;
  Rims rims{RimOf(truth, path, width, options), RimOf(estimate, path, width, options)};
  if (truth.is_unseen.empty()) return rims;
  const std::vector<bool> is_near_unseen =
      truth.raster.Widen(truth.is_unseen, width, options.max_height_gap);
  for (size_t i = 0; i < is_near_unseen.size(); ++i)
    if (is_near_unseen[i]) rims.of_truth[i] = false;
  for (size_t i = 0; i < estimate.samples().size(); ++i) {
    const int found = truth.Find(estimate.samples()[i], options.max_height_gap);
    if (found >= 0 && is_near_unseen[static_cast<size_t>(found)]) rims.of_estimate[i] = false;
  }
  return rims;
}

}  // namespace parkade
