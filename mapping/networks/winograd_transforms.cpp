#include "mapping/networks/winograd_transforms.h"

#include "mapping/networks/vectors.h"

namespace parkade {
namespace {

/// B^T d of six values.
template <typename Floats>
PARKADE_INLINE void TransformSix(const Floats (&d)[6], Floats (&to)[6]) {
  const Floats even = d[4] - 4 * d[2], odd = d[3] - 4 * d[1];
  const Floats far_even = d[4] - d[2], far_odd = 2 * (d[3] - d[1]);
  to[0] = 4 * d[0] - 5 * d[2] + d[4];
  to[1] = even + odd;
  to[2] = even - odd;
  to[3] = far_even + far_odd;
  to[4] = far_even - far_odd;
  to[5] = 4 * d[1] - 5 * d[3] + d[5];
}

/// A^T m of six values.
template <typename Floats>
PARKADE_INLINE void TransformToFour(const Floats (&m)[6], Floats (&to)[4]) {
  const Floats near_sum = m[1] + m[2], near_difference = m[1] - m[2];
  const Floats far_sum = m[3] + m[4], far_difference = m[3] - m[4];
  to[0] = m[0] + near_sum + far_sum;
  to[1] = near_difference + 2 * far_difference;
  to[2] = near_sum + 4 * far_sum;
  to[3] = near_difference + 8 * far_difference + m[5];
}

template <typename Vectors>
PARKADE_INLINE void TransformPatchIn(const float* patch, const PatchSteps& steps, float* planes,
                                     std::size_t plane_step) {
  using Floats = typename Vectors::Floats;
  for (std::size_t channel = 0; channel < steps.step; channel += Vectors::kLength) {
    Floats half[6][6];
#pragma GCC unroll 6
    for (std::size_t column = 0; column < 6; ++column) {
      Floats d[6], to[6];
#pragma GCC unroll 6
      for (std::size_t row = 0; row < 6; ++row)
        d[row] = Vectors::At(patch + row * steps.row_step + column * steps.step + channel).values;
      TransformSix(d, to);
#pragma GCC unroll 6
      for (std::size_t row = 0; row < 6; ++row) half[row][column] = to[row];
    }
#pragma GCC unroll 6
    for (std::size_t row = 0; row < 6; ++row) {
      Floats to[6];
      TransformSix(half[row], to);
#pragma GCC unroll 6
      for (std::size_t column = 0; column < 6; ++column)
        Vectors::Store(to[column], planes + (row * 6 + column) * plane_step + channel);
    }
  }
}

template <typename Vectors>
PARKADE_INLINE void TransformSumsIn(const float* planes, std::size_t plane_step,
                                    const WinogradTile& tile) {
  using Floats = typename Vectors::Floats;
  const PatchSteps& steps = tile.steps;
  for (std::size_t channel = 0; channel < steps.step; channel += Vectors::kLength) {
    Floats half[4][6];
#pragma GCC unroll 6
    for (std::size_t column = 0; column < 6; ++column) {
      Floats m[6], to[4];
#pragma GCC unroll 6
      for (std::size_t row = 0; row < 6; ++row)
        m[row] = Vectors::At(planes + (row * 6 + column) * plane_step + channel).values;
      TransformToFour(m, to);
#pragma GCC unroll 4
      for (std::size_t row = 0; row < 4; ++row) half[row][column] = to[row];
    }
    const Floats bias = Vectors::At(tile.finish.bias + channel).values;
    for (int row = 0; row < tile.rows; ++row) {
      Floats to[4];
      TransformToFour(half[row], to);
      for (int column = 0; column < tile.columns; ++column) {
        const std::size_t at = static_cast<std::size_t>(row) * steps.row_step +
                               static_cast<std::size_t>(column) * steps.step + channel;
        Floats sum = to[column] + bias;
        StoreFinished<Vectors>(tile.finish, sum, at, tile.data);
      }
    }
  }
}

}  // namespace

void TransformPatch(const float* patch, const PatchSteps& steps, float* planes,
                    std::size_t plane_step) {
  RunInVectors([&](auto vectors) PARKADE_INLINE_CALL {
    TransformPatchIn<decltype(vectors)>(patch, steps, planes, plane_step);
  });
}

void TransformSums(const float* planes, std::size_t plane_step, const WinogradTile& tile) {
  RunInVectors([&](auto vectors) PARKADE_INLINE_CALL {
    TransformSumsIn<decltype(vectors)>(planes, plane_step, tile);
  });
}

}  // namespace parkade
