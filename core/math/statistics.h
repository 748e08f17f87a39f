#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace parkade {

/// The value before which `rank` others come when they are sorted. `rank` must be less than their
/// number. Reorders the values; O(n).
template <typename Value>
Value NthSmallest(std::vector<Value>& values, std::size_t rank) {
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

/// The upper one of an even number; 0 of none.
template <typename Value>
Value Median(std::vector<Value> values) {
  return values.empty() ? Value{} : NthSmallest(values, values.size() / 2);
}

/// The value at a share (0 the least, 1 the greatest) of the way through all, by the nearest rank;
/// 0 of none.
inline double Quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const long rank = std::lround(share * static_cast<double>(values.size() - 1));
  return NthSmallest(values, static_cast<std::size_t>(rank));
}

/// The standard deviation about `center` of values that are normally distributed but for outliers:
/// from the median of absolute deviations (MAD).
inline double MadSigma(std::vector<double> values, double center) {
  constexpr double kSigmaPerMad = 1.4826;
  for (double& value : values) value = std::abs(value - center);
  return kSigmaPerMad * Median(std::move(values));
}

}  // namespace parkade
