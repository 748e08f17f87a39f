#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/ground_markings.h"

namespace parkade {

/// Raise it whenever the stored form of a drive's slots changes, or the way they are found from the
/// same inputs.
constexpr int kDriveSlotsVersion = 3;

// Encodes as slam/sessions/stage_results.h does: exactly, but without the slots' states.

std::string EncodeDriveSlots(std::vector<ParkingSlot> slots);
/// The inverse. Throws Error{kInvalidInput} for other bytes.
std::vector<ParkingSlot> DecodeDriveSlots(std::string_view bytes);

}  // namespace parkade
