#include "mapping/networks/doubled_row.h"

#include <algorithm>

#include "mapping/networks/layer_finish.h"

namespace parkade {
namespace {

constexpr float kNear = 0.75F, kFar = 0.25F;  // centers are a fourth of a pixel off

template <typename Vectors>
PARKADE_INLINE void FillDoubledRowIn(const DoubledRow& row) {
  using Floats = typename Vectors::Floats;
  const LayerFinish finish{.added = row.added};
  for (std::size_t channel = 0; channel < row.step; channel += Vectors::kLength) {
    Floats here = kNear * Vectors::At(row.near + channel).values +
                  kFar * Vectors::At(row.far + channel).values;
    Floats before = here;
    for (std::size_t column = 0; column < row.width; ++column) {
      const std::size_t next = std::min(column + 1, row.width - 1) * row.step + channel;
      const Floats behind =
          kNear * Vectors::At(row.near + next).values + kFar * Vectors::At(row.far + next).values;
      Floats left = kNear * here + kFar * before, right = kNear * here + kFar * behind;
      const std::size_t at = 2 * column * row.step + channel;
      StoreFinished<Vectors>(finish, left, at, row.output);
      StoreFinished<Vectors>(finish, right, at + row.step, row.output);
      before = here;
      here = behind;
    }
  }
}

}  // namespace

void FillDoubledRow(const DoubledRow& row) {
  RunInVectors([&](auto vectors) PARKADE_INLINE_CALL { FillDoubledRowIn<decltype(vectors)>(row); });
}

}  // namespace parkade
