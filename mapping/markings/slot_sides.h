#pragma once

#include <array>
#include <vector>

#include "core/ground_markings.h"
#include "mapping/markings/ground_tiles.h"

namespace parkade {

/// What is seen where a line should be.
enum class PaintSeen {
  kUnknown,  ///< too little of the ground, or neither clearly
  kPainted,
  kBare,
};

/// The lines at the right and the left of a slot, looking in from its entrance.
using SlotSides = std::array<PaintSeen, 2>;

/// Measures how much brighter a texture is along the lines beside slots than at both sides of them,
/// averaged along each whole line: far fainter paint than FindPaintLines finds still shows, as
/// does ground without any. Lines may lie a hand's breadth beside where they are looked for. In
/// parallel over tiles. O(pixels of tiles + length of lines).
std::vector<SlotSides> SeeSides(const GroundTiles& tiles, const std::vector<ParkingSlot>& slots);

}  // namespace parkade
