#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

/// The loops of FlowPatch over samples, in integers. Rows of samples follow each other without
/// gaps, and have some more samples than the patch has columns.
namespace parkade::flow {

inline constexpr int kMaxStride = 23;    ///< and rows
inline constexpr int kReadColumns = 32;  ///< of each row of pixels, and one more: whole vectors

inline constexpr int kValueBits = 6;   ///< a gray level is 64
inline constexpr int kShareBits = 15;  ///< a pixel is 32768 between two samples
inline constexpr int kSlopeBits = 3;   ///< a gray level per pixel is 8
inline constexpr int kMoreBits = 4;    ///< a gray level of what is seen more than expected is 16

/// With room for what loops write behind the last row.
using Samples =
    std::array<std::int16_t, static_cast<size_t>(kMaxStride) * (kMaxStride + 1) + kReadColumns>;

/// Where bilinear samples lie: `u` to the right and `v` down of pixels, in 2^-15.
struct SampledRows {
  const std::uint8_t* pixels = nullptr;  ///< up and left of the first sample
  std::ptrdiff_t step = 0;               ///< from row to row of pixels
  std::int16_t u = 0, v = 0;
  int rows = 0, stride = 0;  ///< of the samples
};

void Sample(const SampledRows& from, Samples& samples);

/// Scharr's derivatives of the samples that are one further to the right and down than theirs, of
/// which there are two rows more; 0 where `is_inside` is, which else is -1.
void Differentiate(const Samples& samples, const Samples& is_inside, int rows, int stride,
                   Samples& slopes_x, Samples& slopes_y);

struct Products {
  std::int32_t xx = 0, xy = 0, yy = 0;  ///< [2^(-2 kSlopeBits) (gray levels / px)^2]
};

/// Sums over the first `size` slopes.
Products SumProducts(const Samples& slopes_x, const Samples& slopes_y, int size);

struct Mismatch {
  std::int32_t x = 0, y = 0;  ///< [2^(-kMoreBits - kSlopeBits) (gray levels)^2 / px]
};

/// What is sampled more than expected, times the slopes.
Mismatch Compare(const SampledRows& from, const std::int16_t* expected, const Samples& slopes_x,
                 const Samples& slopes_y);

}  // namespace parkade::flow
