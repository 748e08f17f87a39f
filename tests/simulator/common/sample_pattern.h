#pragma once

#include <array>
#include <cstdint>

#include "tests/simulator/common/random.h"

namespace parkade::simulator {

/// Every pixel has four samples; one whose samples differ, as at an edge, has these twelve more.
inline constexpr int kSamplesPerPixel = 4, kSamplesPerEdgePixel = 16;
inline constexpr int kNumMoments = 16;  ///< into which an exposure is divided

/// Places of the samples in a pixel: first a rotated grid of four, then Hammersley points but for
/// the four that are nearest to those. Always the same places, so that nothing flickers; the mean
/// of both is the center.
inline constexpr std::array<std::array<float, 2>, kSamplesPerEdgePixel> kSampleOffsets = {
    {{-0.125f, -0.375f},
     {0.375f, -0.125f},
     {-0.375f, 0.125f},
     {0.125f, 0.375f},
     {-0.46875f, -0.46875f},
     {-0.34375f, -0.21875f},
     {-0.28125f, 0.28125f},
     {-0.15625f, 0.15625f},
     {-0.09375f, -0.09375f},
     {-0.03125f, 0.40625f},
     {0.03125f, -0.40625f},
     {0.09375f, 0.09375f},
     {0.15625f, -0.15625f},
     {0.28125f, -0.28125f},
     {0.34375f, 0.21875f},
     {0.46875f, 0.46875f}}};

/// The moments of a pixel's samples, each in its own sixteenth of the exposure, the first four in
/// different quarters. The order was searched for what makes the least error of places in moving
/// images; it is scrambled by a number of the pixel, since places and moments that go together in
/// all pixels alike would favor directions of motion.
class PixelMoments {
 public:
  PixelMoments(int column, int row)
      : scramble_(
            Mix64((static_cast<std::uint64_t>(row) << 32) ^ static_cast<std::uint64_t>(column)) >>
            60) {}

  /// 0..kNumMoments-1, growing with time.
  std::uint8_t Of(int sample) const {
    constexpr std::array<std::uint8_t, kSamplesPerEdgePixel> kOrder = {10, 1, 5, 13, 0,  15, 14, 4,
                                                                       2,  9, 3, 7,  12, 8,  11, 6};
    return static_cast<std::uint8_t>(kOrder[static_cast<std::size_t>(sample)] ^ scramble_);
  }

 private:
  std::uint64_t scramble_;
};

}  // namespace parkade::simulator
