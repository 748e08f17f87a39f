#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/ground_markings.h"
#include "mapping/ground/driven_path.h"
#include "mapping/ground/patch_source.h"

namespace parkade {

/// What drives saw in a slot, by drive; nothing where that is not known yet. Drives beyond its end
/// are not known either.
using KnownStates = std::vector<std::optional<SlotState>>;

/// What each of `num_drives` drives saw in each slot: ground, something that stands there, or too
/// little to tell. A sample of a drive counts where its ray meets the slot's own plane; what is
/// hidden does not count. At least forty views of a slot are read of each drive that has them, near
/// ones (ChooseNearest). Sets ParkingSlot::states.
///
/// \param known  by slot, or empty: what is known is not looked for again, so that what a further
///               drive costs does not grow with the number of those before
void SeeSlots(const PatchSource& patches, std::span<const DrivenPath> paths, std::size_t num_drives,
              std::vector<ParkingSlot>& slots, std::span<const KnownStates> known = {});

}  // namespace parkade
