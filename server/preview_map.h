#pragma once

#include <filesystem>
#include <string>

#include "core/site_map.h"

namespace parkade {

/// What a map will look like, moments after its trajectories are final: the ground of the map that it is built from,
/// bent as the trajectories of the drives of both have bent (DeformGround), textured as it was, as a .glb. Ground that
/// only a new drive saw is not in it yet; ground that no drive came near which is left is not in it any more.
///
/// \param from  the finished map's folder
/// \param site  of the map in the making: drives and datum are read
/// Throws Error{kInvalidInput} where the old map has no ground, or no drive in common with `site`.
std::string EncodePreview(const std::filesystem::path& from, const SiteMap& site);

}  // namespace parkade
