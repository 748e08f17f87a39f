#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace parkade {

/// The median: the upper one of an even number of values; 0 without any.
inline double MedianOf(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace parkade
