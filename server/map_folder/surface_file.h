#pragma once

#include <filesystem>

#include "core/surface_map.h"

namespace parkade {

/// Writes the fused ground of a map, so that versions can be compared: binary, little-endian,
/// compressed, with a version and a checksum; one or two bytes per cell. Heights and sigmas to the
/// millimeter, beliefs to 1/255, no colors. Whole or not at all.
void WriteSurface(const SurfaceMap& surface, const std::filesystem::path& file);

/// Reads what WriteSurface wrote. Throws Error{kNotFound} without the file, Error{kInvalidInput}
/// where it is damaged or of another version.
SurfaceMap ReadSurface(const std::filesystem::path& file);

}  // namespace parkade
