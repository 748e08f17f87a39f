#pragma once

#include <vector>

#include "server/map_folder/map_reader.h"
#include "slam/places/rig_keyframe.h"

namespace parkade {

/// Reads the keyframes that a finished map keeps along its drives, by drive;
/// RigKeyframe::odom_from_keyframe is where they lie in its site. Drives without stored keyframes
/// (an older version of this program made the map) are left out.
std::vector<std::vector<RigKeyframe>> ReadSiteKeyframes(const MapReader& map);

}  // namespace parkade
