#pragma once

#include <vector>

#include "mapping/markings/merge_slots.h"
#include "server/pipeline/drive_slots.h"
#include "server/pipeline/progress.h"

namespace parkade {

/// What is known of a site's slots before all drives are looked at together, in its frame: the
/// slots of the map that the build starts from, then those that each drive alone shows which that
/// map does not tell of. The latest drive is not looked at alone: it is what the site shows.
///
/// Slots of the earlier map count by their names. They count as slots, too, where the new map has
/// all its drives and their poses have not moved against each other there: else what it found may
/// have been its mistake, and its drives are looked at again.
std::vector<SlotLook> LooksBefore(const BuildContext& context,
                                  const std::vector<DriveInWork>& drives, const SiteGround& ground,
                                  const SiteMap& map, Progress& progress);

/// Names the slots that no look before has named, and keeps those of a drive alone.
void NameAndKeepSlots(const BuildContext& context, const std::vector<DriveInWork>& drives,
                      const SiteGround& ground, SiteMap& map);

}  // namespace parkade
