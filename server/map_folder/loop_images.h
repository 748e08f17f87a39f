#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "core/rig.h"
#include "slam/loops/close_loops.h"

namespace parkade {

/// The loops of a drive for report.json: what ToJson gives, with cameras by name, and the names of
/// the images that WriteLoopImages writes.
nlohmann::json LoopsToJson(const LoopClosure& closure, const Rig& rig, const std::string& drive);

/// Writes small JPEG images of both ends of every loop, accepted or not, into folder/DRIVE/loops.
/// Keyframes that several loops share are written once; about 4 KB each.
void WriteLoopImages(const LoopClosure& closure, const Rig& rig, const std::string& drive,
                     const std::filesystem::path& folder);

}  // namespace parkade
