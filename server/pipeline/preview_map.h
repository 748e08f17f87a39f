#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "core/site_map.h"
#include "server/pipeline/build_map.h"

namespace parkade {

/// What a map will look like, moments after its trajectories are final: the ground of the map that it is built from,
/// bent as the trajectories of the drives of both have bent (DeformGround), textured as it was, as a .glb. Ground that
/// only a new drive saw is not in it yet; ground that no drive came near which is left is not in it any more.
/// `asset.extras.preview` is "final".
///
/// \param from  the finished map's folder
/// \param site  of the map in the making: drives and datum are read
/// Throws Error{kInvalidInput} where the old map has no ground, or no drive in common with `site`.
std::string EncodePreview(const std::filesystem::path& from, const LogHashes& logs, const SiteMap& site);

/// The same as soon as loops are closed and before anything is refined: the old map's ground and all its drives as one
/// problem (RegraphSite, DeformJointly), in the frame of the old map. `asset.extras.preview` is "joint". Nothing where
/// no drive of the old map has other loops than it had, or where one of them was tracked again: the next preview is the
/// final one. Throws as EncodePreview.
std::optional<std::string> EncodeJointPreview(const std::filesystem::path& from, const LogHashes& logs,
                                              std::span<const ClosedDrive> drives, const LoopOptions& options);

}  // namespace parkade
