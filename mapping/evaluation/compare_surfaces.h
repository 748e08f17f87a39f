#pragma once

#include "core/rigid3.h"
#include "core/surface_changes.h"
#include "core/surface_map.h"

namespace parkade {

struct CompareOptions {
  double sure_belief =
      0.65;  ///< from which a cell is drivable for sure; below 1 - this it is not, for sure
  double min_width =
      0.4;  ///< [m] and three sigmas: narrower strips are borders that moved, no changes
  double min_area = 1.0;  ///< [m^2] smaller regions are left out
  double min_height_change =
      0.05;  ///< [m] and three sigmas, beside the ground around, of what is raised or lowered
  double level_separation = 1.0;  ///< [m] heights further apart are different decks

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("sure_belief", sure_belief);
    visit("min_width", min_width);
    visit("min_area", min_area);
    visit("min_height_change", min_height_change);
    visit("level_separation", level_separation);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

/// Where the earlier version's site lies in the later one's.
struct SiteMotion {
  Rigid3 to_from_from = {};
  double horizontal_sigma = 0;  ///< [m] per axis
  double height_sigma = 0;      ///< [m]
};

/// What changed on the ground from one version of a map to a later one. Nothing counts that may
/// come from how the two were laid on each other (three sigmas of `motion`). A cell counts as
/// changed where one version is sure that it is drivable and the other says that it is not, or does
/// not know it; then what is narrower than `min_width` goes (morphological opening, decks apart),
/// and what is left is grouped into connected regions. One is freed or blocked where a tenth of it
/// is surely an obstacle, as the foot of a parked car is; else it came into view or went out
/// of it. Ground is raised or lowered beside the ground around it (HeightDrift). Deterministic.
/// O(number of cells), but for sorting.
SurfaceChanges CompareSurfaces(const SurfaceMap& from, const SurfaceMap& to,
                               const SiteMotion& motion, const CompareOptions& options = {});

}  // namespace parkade
