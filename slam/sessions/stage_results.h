#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/appended_file.h"
#include "slam/loops/close_loops.h"
#include "slam/refinement/refine_drive.h"
#include "slam/sessions/drive_links.h"

namespace parkade {

// What stages found, as bytes, so that a later build with the same inputs need not find it again. Little-endian, no
// version of their own: who keeps them knows what they are. Exact: what is read equals what was written, but that the
// seconds of computing are 0. Reading throws Error{kInvalidInput} for bytes that are none.

/// Raised whenever one of the layouts, or what a stage does with the same inputs, changes.
constexpr int kStageResultsVersion = 3;

std::string EncodeLoops(LoopClosure loops);
LoopClosure DecodeLoops(std::string_view bytes);

/// \param rig  of the odometry, whose lenses and masks stay
std::string EncodeRefinement(DriveRefinement refinement);
DriveRefinement DecodeRefinement(std::string_view bytes, const Rig& rig);

std::string EncodePlaces(const std::vector<Place>& places);
std::vector<Place> DecodePlaces(std::string_view bytes);

/// What EncodePlaces gives, in pieces, of places that come one by one. Holds one at a time: floors, which come last,
/// wait on disk.
class PlacesEncoder {
 public:
  /// `num_places` will be added. `sink` gets the bytes in order.
  PlacesEncoder(size_t num_places, std::function<void(std::string_view)> sink);
  void Add(Place place);
  /// Last.
  void Finish();

 private:
  std::function<void(std::string_view)> sink_;
  AppendedFile floors_;
};

std::string EncodeLinks(DriveLinks links);
DriveLinks DecodeLinks(std::string_view bytes);

}  // namespace parkade
