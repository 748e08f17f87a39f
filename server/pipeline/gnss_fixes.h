#pragma once

#include <optional>
#include <string>

#include "core/site_map.h"
#include "slam/refinement/drive_refinement.h"

namespace parkade {

/// gnss.json of a drive: where its fixes lie in the site, whether each was used to place the drive
/// (`state`), and how far it is from the antenna's way. Times are seconds since `start`. Nothing
/// where the drive has no fixes, or the site no datum.
///
/// \param alignment  of the drive; nothing: its fixes did not say where it lies
std::optional<std::string> EncodeGnssFixes(const SiteDrive& drive, const GnssPositions& gnss,
                                           const std::optional<GnssAlignment>& alignment,
                                           const std::optional<SiteDatum>& datum);

}  // namespace parkade
