#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/surface_map.h"

namespace parkade {

/// What became of ground between two versions of a map.
enum class GroundChange {
  kFreed,     ///< was seen and not drivable, is drivable
  kBlocked,   ///< was drivable, is seen and not drivable
  kMapped,    ///< was not seen, is drivable
  kUnmapped,  ///< was drivable, is not seen
  kRaised,    ///< drivable in both, higher now beside the ground around
  kLowered,   ///< drivable in both, lower now
};

/// "freed", "blocked", ...
inline const char* ToText(GroundChange change) {
  switch (change) {
    case GroundChange::kFreed: return "freed";
    case GroundChange::kBlocked: return "blocked";
    case GroundChange::kMapped: return "mapped";
    case GroundChange::kUnmapped: return "unmapped";
    case GroundChange::kRaised: return "raised";
    case GroundChange::kLowered: return "lowered";
  }
  return "";
}

/// One connected piece of ground that changed in one way.
struct ChangedRegion {
  GroundChange change = GroundChange::kFreed;
  double area = 0;                                   ///< [m^2]
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< [m] in the later map's site
  double height_change = 0;  ///< [m] mean, beside the ground around, where drivable in both; else 0
  std::vector<SurfaceCell> cells = {};  ///< in the later map's grid
};

/// Heights of ground that is drivable in both versions, later minus earlier [m].
struct HeightChange {
  double median = 0, rmse = 0;
  double percentile_95 = 0;  ///< of absolute values
};

/// How the ground of one version of a map differs from that of an earlier one, in the later one's
/// site and grid.
struct SurfaceChanges {
  double cell_size = 0;                     ///< [m]
  std::vector<ChangedRegion> regions = {};  ///< by kind, then the largest first
  std::vector<SurfaceCell> unchanged = {};  ///< drivable in both
  HeightChange height = {};

  /// [m^2] of all regions of one kind.
  double AreaOf(GroundChange change) const {
    double area = 0;
    for (const ChangedRegion& region : regions)
      if (region.change == change) area += region.area;
    return area;
  }
  double UnchangedArea() const {
    return static_cast<double>(unchanged.size()) * cell_size * cell_size;
  }
};

}  // namespace parkade
