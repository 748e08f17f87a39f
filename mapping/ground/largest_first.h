#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <type_traits>
#include <vector>

#include "core/parallel.h"

namespace parkade {

/// Does what ParallelMap does, but begins with the largest by `size_of(i)`, so that no thread is
/// left with a large one while the others have nothing more to do.
template <typename SizeOf, typename Body>
auto ParallelMapLargestFirst(std::size_t count, const SizeOf& size_of, const Body& body) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return size_of(a) > size_of(b); });
  std::vector<std::invoke_result_t<Body, std::size_t>> results(count);
  ParallelFor(count, [&](std::size_t i) { results[order[i]] = body(order[i]); });
  return results;
}

}  // namespace parkade
