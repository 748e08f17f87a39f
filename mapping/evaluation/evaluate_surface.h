#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/triangle_mesh.h"
#include "mapping/evaluation/scoped_surfaces.h"

namespace parkade {

/// All areas are measured on the raster, seen from above; decks count each.
struct SurfaceEvaluation {
  std::size_t num_samples = 0;  ///< of the estimate on true ground
  double truth_area = 0;        ///< [m^2] that counts
  double estimate_area = 0;     ///< [m^2]
  double height_rmse = 0;       ///< [m] where both are
  double height_bias = 0;       ///< [m] mean of estimate - truth
  double height_median = 0;     ///< [m] of absolute differences, as the next three
  double height_p90 = 0, height_p95 = 0, height_max = 0;
  double beyond_two_sigmas_percent = 0;  ///< of the estimate's area on true ground, by its sigmas
  double accuracy_rmse =
      0;  ///< [m] distance of each sample of the estimate to the truth, false ones too
  double completeness_percent =
      0;  ///< of the truth, with an estimate within max_completeness_distance
  double false_free_percent = 0;  ///< of the estimate, where there is no true ground
  double iou = 0;                 ///< of the areas
  double boundary_iou = 0;        ///< of what lies within boundary_width of the own outline
  double relative_boundary_iou =
      0;  ///< boundary IoU, over the width that its authors use by default:
  double relative_boundary_width = 0;  ///< [m] 2 % of the diagonal of the truth that counts
  double ramp_area = 0;         ///< [m^2] of the estimate where the truth is steeper than 5 %
  double ramp_height_rmse = 0;  ///< [m] there
};

/// Compares an estimated ground surface with the true one, both in one frame with z up. Accuracy
/// and false free space are of the estimate within the scope, completeness of the truth within it,
/// IoUs of both. Accuracy and completeness: T. Schoeps et al., "A Multi-view Stereo Benchmark ...",
/// CVPR 2017. Boundary IoU: B. Cheng et al., "Boundary IoU", CVPR 2021. Throws Error{kInvalidInput}
/// when either mesh is empty.
SurfaceEvaluation EvaluateSurface(const TriangleMesh& truth, const TriangleMesh& estimate,
                                  const SurfaceEvaluationOptions& options = {},
                                  const SurfaceScope& scope = {});

/// The same of rasters that are there already; `estimate_mesh` has the sigmas.
SurfaceEvaluation EvaluateSurface(const ScopedSurfaces& surfaces, const TriangleMesh& estimate_mesh,
                                  const SurfaceEvaluationOptions& options);

/// A few aligned lines for people.
std::string ToText(const SurfaceEvaluation& evaluation);

/// Every field under its own name.
nlohmann::json ToJson(const SurfaceEvaluation& evaluation);

}  // namespace parkade
