#pragma once

#include <cstddef>

#include "mapping/networks/vectors.h"

namespace parkade {

/// What becomes of a layer's sums: + bias, then not below zero, then + what is added.
struct LayerFinish {
  const float* bias = nullptr;  ///< of whole groups of channels; none where null
  bool is_rectified = false;
  const float* added = nullptr;  ///< as large as the output and in its order; none where null
};

/// All but the bias, and writes float `at` of the output and those behind it.
template <typename Vectors>
PARKADE_INLINE void StoreFinished(const LayerFinish& finish, typename Vectors::Floats& sum,
                                  std::size_t at, float* output) {
  using Floats = typename Vectors::Floats;
  if (finish.is_rectified) sum = sum > 0 ? sum : Floats{};
  if (finish.added != nullptr) sum += Vectors::At(finish.added + at).values;
  Vectors::Store(sum, output + at);
}

}  // namespace parkade
