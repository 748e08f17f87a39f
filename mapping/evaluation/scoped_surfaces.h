#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "core/triangle_mesh.h"
#include "mapping/evaluation/height_raster.h"

namespace parkade {

struct SurfaceEvaluationOptions {
  double sample_spacing = 0.1;  ///< [m] both meshes are compared on a raster this fine
  double max_height_gap =
      0.5;  ///< [m] surfaces above each other further apart are not the same ground
  double max_completeness_distance = 0.2;  ///< [m] truth with an estimate this near counts as found
  double boundary_width =
      0.5;  ///< [m] inside their outlines in which the boundary IoU compares the two
  double max_path_distance =
      12;  ///< [m] only ground this near the path counts, where a path is given

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("sample_spacing", sample_spacing);
    visit("max_height_gap", max_height_gap);
    visit("max_completeness_distance", max_completeness_distance);
    visit("boundary_width", boundary_width);
    visit("max_path_distance", max_path_distance);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

/// Which ground counts. A drive is not blamed for what it never came near, nor for what nothing
/// could see; the outline of this scope is no outline of the ground.
struct SurfaceScope {
  std::span<const Eigen::Vector3d> path =
      {};  ///< points of the drive: only ground near them; empty: everything
  /// Which of these points of the true surface were seen as drivable; none: all of them. What was
  /// not is neither missed nor false, and no rim counts that may be one only because of it.
  std::function<std::vector<bool>(const std::vector<Eigen::Vector3d>& points)> find_seen = {};
};

/// A surface on its raster, and which of it counts.
struct ScopedRaster {
  HeightRaster raster;
  std::vector<bool> counts;      ///< of samples
  std::vector<bool> is_unseen;   ///< of samples of the truth: in the scope but for that
  std::size_t num_in_scope = 0;  ///< those near the path, whether seen or not

  const std::vector<HeightRaster::Sample>& samples() const { return raster.samples(); }
  int Find(const HeightRaster::Sample& at, double max_gap) const {
    return raster.Find(at.x, at.y, at.height, max_gap);
  }
};

struct ScopedSurfaces {
  ScopedRaster truth, estimate;
  std::vector<Eigen::Vector3d> path;  ///< of the scope
};

/// Throws Error{kInvalidInput} when either mesh is empty.
ScopedSurfaces ScopeSurfaces(const TriangleMesh& truth, const TriangleMesh& estimate,
                             const SurfaceEvaluationOptions& options, const SurfaceScope& scope);

/// Samples of the rims of both, some width [m] wide. Where a hole would be outside of the scope or
/// unseen it would be no outline: what is so near to that counts for neither.
struct Rims {
  std::vector<bool> of_truth, of_estimate;
};

Rims FindRims(const ScopedSurfaces& surfaces, double width,
              const SurfaceEvaluationOptions& options);

}  // namespace parkade
