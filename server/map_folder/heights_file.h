#pragma once

#include <string>
#include <string_view>

#include "mapping/heights/drive_heights.h"

namespace parkade {

/// Raise it whenever the stored form of a drive's ground or heights changes, or the way they are
/// found from the same inputs.
constexpr int kGroundVersion = 8;
/// Also for heights alone.
constexpr int kHeightsVersion = 1;

// Encodes as slam/sessions/stage_results.h does: exactly, but without the number of the drive.

std::string EncodeHeights(DriveHeights heights);
/// The inverse. Throws Error{kInvalidInput} for other bytes.
DriveHeights DecodeHeights(std::string_view bytes);

}  // namespace parkade
