#pragma once

#include <span>
#include <vector>

#include "core/ground_markings.h"
#include "core/option_about.h"
#include "core/surface_map.h"
#include "core/triangle_mesh.h"
#include "mapping/ground/driven_path.h"
#include "mapping/ground/patch_source.h"

namespace parkade {

struct KerbOptions {
  double min_height = 0.04;  ///< [m] above the ground beside it; less is a joint or a dropped kerb

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("min_height", min_height, OptionAbout{"A kerb is at least this high.", "m", 0.01, 0.2});
  }
  void Validate() const;  ///< throws Error{kUsage}
};

/// Where the drivable ground ends at a step up to something level, and how high that is.
///
/// Along the outline of the mesh a sweep of its own (SweepStrips) looks just beyond it: views from
/// different places agree at the height of what is level there, next to the outline and farther off
/// alike. Walls and parked cars agree at no height more than at others. The ground before the
/// outline is swept, too, and its height taken off. What strips along the outline say is put
/// together (MeasureSteps), and what a network takes for a kerb (LookBeyond) is believed unless it
/// is seen to be flat. Kerbs go straight on (ContinueLines). Strips that follow each other are one
/// kerb; short gaps that say nothing are bridged. Kerbs lean on each other's heights
/// (LeanOnNeighbors) and go on behind parked cars (CloseGaps). O(samples near the outline, and
/// kerbs squared); in parallel, the same every time.
std::vector<Kerb> FindKerbs(const TriangleMesh& mesh, const SurfaceMap& surface,
                            const PatchSource& patches, std::span<const DrivenPath> paths,
                            const KerbOptions& options = {});

}  // namespace parkade
