#pragma once

#include <span>
#include <vector>

#include "core/ground_markings.h"
#include "mapping/ground/driven_path.h"
#include "mapping/ground/patch_source.h"

namespace parkade {

/// What each of `num_drives` drives saw in each slot: ground, something that stands there, or too
/// little to tell. A sample of a drive counts where its ray meets the slot's own plane; what is
/// hidden does not count. At least forty views of a slot are read of each drive that has them, near
/// ones (ChooseNearest). Sets ParkingSlot::states.
void SeeSlots(const PatchSource& patches, std::span<const DrivenPath> paths, std::size_t num_drives,
              std::vector<ParkingSlot>& slots);

}  // namespace parkade
