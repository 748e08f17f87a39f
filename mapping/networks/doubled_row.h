#pragma once

#include <cstddef>

namespace parkade {

/// One row of an image of twice the size.
struct DoubledRow {
  const float* near = nullptr;   ///< row of the image that it lies in
  const float* far = nullptr;    ///< the next nearest, half a row beyond that one's border
  std::size_t width = 0;         ///< [px] of these
  std::size_t step = 0;          ///< floats from pixel to pixel, of whole groups
  const float* added = nullptr;  ///< to the output, as long; none where null
  float* output = nullptr;
};

void FillDoubledRow(const DoubledRow& row);

}  // namespace parkade
