#pragma once

#include <filesystem>

#include "core/rig.h"

namespace parkade {

/// Reads a rig's three files in one, as a map has them for each drive (calibration.yaml): without
/// masks. Throws as ReadRig.
Rig ReadCalibration(const std::filesystem::path& file);

}  // namespace parkade
