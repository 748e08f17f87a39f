#include "slam/tracking/flow_kernels.h"

#include "core/math/vectorized.h"

// What one loop writes the next one reads elsewhere in its vectors: processors wait for such values
// unless they were written a while ago. So each loop runs over all rows.

namespace parkade::flow {
namespace {

/// What belongs of `step` to a share of 2^15: one instruction multiplies and drops 16 bits.
__attribute__((always_inline)) inline int Part(int step, std::int16_t share) {
  const auto doubled = static_cast<std::int16_t>(2 * step);
  return static_cast<std::int16_t>((doubled * share) >> (kShareBits + 1));
}

/// Samples between columns, one row more.
__attribute__((always_inline)) inline void InterpolateAlong(const SampledRows& from,
                                                            std::int16_t* __restrict to) {
  const std::uint8_t* __restrict pixels = from.pixels;
  const std::int16_t u = from.u;
  const int rows = from.rows, stride = from.stride;
  for (int row = 0; row <= rows; ++row, pixels += from.step, to += stride) {
    for (int i = 0; i < kReadColumns; ++i) {
      const auto left = static_cast<std::int16_t>(pixels[i] << kValueBits);
      const auto step = static_cast<std::int16_t>((pixels[i + 1] - pixels[i]) << kValueBits);
      to[i] = static_cast<std::int16_t>(left + Part(step, u));
    }
  }
}

/// The sample between two rows.
__attribute__((always_inline)) inline std::int16_t Between(std::int16_t above, std::int16_t below,
                                                           std::int16_t v) {
  return static_cast<std::int16_t>(above + Part(below - above, v));
}

}  // namespace

PARKADE_VECTORIZED void Sample(const SampledRows& from, Samples& samples) {
  alignas(32) Samples rows;
  InterpolateAlong(from, rows.data());
  const std::int16_t v = from.v, *above = rows.data(), *below = above + from.stride;
  std::int16_t* __restrict to = samples.data();
  const int size = from.rows * from.stride;
  for (int i = 0; i < size; ++i) to[i] = Between(above[i], below[i], v);
}

PARKADE_VECTORIZED void Differentiate(const Samples& samples, const Samples& is_inside, int rows,
                                      int stride, Samples& slopes_x, Samples& slopes_y) {
  alignas(32) Samples smooth, change;
  const std::int16_t *above = samples.data(), *at = above + stride, *below = at + stride;
  const int size = rows * stride;
  for (int i = 0; i < size; ++i) {
    // In gray levels / 8, which 16 times as much leaves in 16 bits.
    const auto a = static_cast<std::int16_t>(above[i] >> 3);
    const auto b = static_cast<std::int16_t>(at[i] >> 3);
    const auto c = static_cast<std::int16_t>(below[i] >> 3);
    smooth[static_cast<size_t>(i)] = static_cast<std::int16_t>(3 * (a + c) + 10 * b);
    change[static_cast<size_t>(i)] = static_cast<std::int16_t>(c - a);
  }
  const std::int16_t *s = smooth.data(), *c = change.data(), *mask = is_inside.data();
  std::int16_t* __restrict to_x = slopes_x.data();
  std::int16_t* __restrict to_y = slopes_y.data();
  for (int i = 0; i < size - 2; ++i) {
    const auto x = static_cast<std::int16_t>(s[i + 2] - s[i]);
    const auto y = static_cast<std::int16_t>(3 * (c[i] + c[i + 2]) + 10 * c[i + 1]);
    to_x[i] = static_cast<std::int16_t>(((x + 16) >> 5) & mask[i]);
    to_y[i] = static_cast<std::int16_t>(((y + 16) >> 5) & mask[i]);
  }
}

PARKADE_VECTORIZED Products SumProducts(const Samples& slopes_x, const Samples& slopes_y,
                                        int size) {
  const std::int16_t *x = slopes_x.data(), *y = slopes_y.data();
  Products sum;
  for (int i = 0; i < size; ++i) {
    sum.xx += x[i] * x[i];
    sum.xy += x[i] * y[i];
    sum.yy += y[i] * y[i];
  }
  return sum;
}

PARKADE_VECTORIZED Mismatch Compare(const SampledRows& from, const std::int16_t* expected,
                                    const Samples& slopes_x, const Samples& slopes_y) {
  alignas(32) Samples rows, more;
  InterpolateAlong(from, rows.data());
  const std::int16_t v = from.v, *above = rows.data(), *below = above + from.stride;
  std::int16_t* __restrict to = more.data();
  const int size = from.rows * from.stride;
  for (int i = 0; i < size; ++i)
    to[i] = static_cast<std::int16_t>((Between(above[i], below[i], v) - expected[i]) >>
                                      (kValueBits - kMoreBits));
  const std::int16_t *x = slopes_x.data(), *y = slopes_y.data();
  Mismatch sum;
  for (int i = 0; i < size; ++i) {
    sum.x += to[i] * x[i];
    sum.y += to[i] * y[i];
  }
  return sum;
}

}  // namespace parkade::flow
