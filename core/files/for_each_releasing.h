#pragma once

#include <algorithm>
#include <cstddef>

#include "core/files/file_backed_vector.h"

namespace parkade {

/// Calls `visit(i)` for the indices of `values` in order, and every now and then lets go of
/// `values` and `others`, so that arrays that are only gone through take hardly any memory.
template <typename Value, typename Visitor, typename... Others>
void ForEachReleasing(const FileBackedVector<Value>& values, const Visitor& visit,
                      const Others&... others) {
  constexpr std::size_t kPart = kMinScratchBytes / sizeof(Value);
  for (std::size_t begin = 0; begin < values.size(); begin += kPart) {
    const std::size_t end = std::min(values.size(), begin + kPart);
    for (std::size_t i = begin; i < end; ++i) visit(i);
    ReleaseMemory(values);
    (ReleaseMemory(others), ...);
  }
}

}  // namespace parkade
