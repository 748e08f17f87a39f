#pragma once

#include <span>
#include <vector>

#include "core/surface_map.h"
#include "mapping/kerbs/outline_strips.h"

namespace parkade {

/// What images show along a strip of the outline.
enum class KerbLook : std::uint8_t {
  kUnknown,  ///< not seen, by no network that tells classes, or not clearly
  kKerb,     ///< a kerb, and pavement or plants behind it
  kNone,     ///< something else
};

/// What the cells of `surface` beside each strip are, by their class beliefs. O(strips), in
/// parallel. \param length  [m] of a strip
std::vector<KerbLook> LookBeyond(std::span<const OutlineStrip> strips, double length,
                                 const SurfaceMap& surface);

}  // namespace parkade
