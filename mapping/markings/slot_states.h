#pragma once

#include <span>
#include <vector>

#include "core/ground_markings.h"
#include "mapping/ground/driven_path.h"
#include "mapping/ground/patch_source.h"

namespace parkade {

struct SlotStateOptions {
  double side_margin =
      0.25;  ///< [m] beside the lines that does not count: who parks badly, and who walks past
  double end_margin = 0.4;       ///< [m] the same at the ends
  double free_share = 0.55;      ///< of what is left that must be seen as ground in a free slot
  double occupied_share = 0.03;  ///< the least share of something else in an occupied one
  void Validate() const;         ///< throws Error{kUsage}
};

/// What each of `num_drives` drives saw in each slot: ground, something that stands there, or too
/// little to tell. A sample of a drive counts where its ray meets the slot's own plane; what is
/// hidden does not count. Sets ParkingSlot::states. O(samples).
void SeeSlots(const PatchSource& patches, std::span<const DrivenPath> paths, std::size_t num_drives,
              const SlotStateOptions& options, std::vector<ParkingSlot>& slots);

}  // namespace parkade
