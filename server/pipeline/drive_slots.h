#pragma once

#include <vector>

#include "core/ground_markings.h"
#include "server/pipeline/build_context.h"
#include "server/pipeline/drive_in_work.h"
#include "server/pipeline/observe_site.h"

namespace parkade {

/// The slots that one drive alone shows, in the frame of its refined odometry, named: fused,
/// meshed, painted and looked at as if it was the only one. A later build takes them from the map
/// that it starts from, so that each drive is looked at once. \param index  of the drive in
/// `ground`
std::vector<ParkingSlot> FindDriveSlots(const BuildContext& context, const DriveInWork& drive,
                                        const SiteGround& ground, size_t index);

/// Keeps the slots of a map of one drive as those that it alone shows.
void KeepDriveSlots(const BuildContext& context, const DriveInWork& drive, const SiteGround& ground,
                    const SiteMap& map);

}  // namespace parkade
