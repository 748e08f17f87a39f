#pragma once

#include <string>
#include <string_view>

#include "mapping/heights/drive_heights.h"

namespace parkade {

/// Raised whenever what is stored of the ground of a drive, or how it is found with the same
/// inputs, changes.
constexpr int kGroundVersion = 4;

// As the results of slam/sessions/stage_results.h: exact, but without the number of the drive.

std::string EncodeHeights(DriveHeights heights);
/// Throws Error{kInvalidInput} for bytes that are none.
DriveHeights DecodeHeights(std::string_view bytes);

}  // namespace parkade
