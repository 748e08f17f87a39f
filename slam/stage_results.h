#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "slam/close_loops.h"
#include "slam/drive_links.h"
#include "slam/refine_drive.h"

namespace parkade {

// What stages found, as bytes, so that a later build with the same inputs need not find it again. Little-endian, no
// version of their own: who keeps them knows what they are. Exact: what is read equals what was written, but that the
// seconds of computing are 0. Reading throws Error{kInvalidInput} for bytes that are none.

/// Raised whenever one of the layouts, or what a stage does with the same inputs, changes.
constexpr int kStageResultsVersion = 1;

std::string EncodeLoops(LoopClosure loops);
LoopClosure DecodeLoops(std::string_view bytes);

/// \param rig  of the odometry, whose lenses and masks stay
std::string EncodeRefinement(DriveRefinement refinement);
DriveRefinement DecodeRefinement(std::string_view bytes, const Rig& rig);

std::string EncodePlaces(std::vector<Place> places);
std::vector<Place> DecodePlaces(std::string_view bytes);

std::string EncodeLinks(DriveLinks links);
DriveLinks DecodeLinks(std::string_view bytes);

}  // namespace parkade
