#pragma once

#include <cmath>
#include <optional>
#include <vector>

namespace parkade {

/// Real roots of c[0] + c[1] x + c[2] x^2 + ... inside (begin, end), in increasing order, where the
/// polynomial changes its sign. For the small degrees of lens models: recursive over the
/// derivative.
std::vector<double> FindSignChanges(const std::vector<double>& coefficients, double begin,
                                    double end);

/// Root of the increasing `function` (value and slope) in [0, max]: Newton, and bisection where
/// Newton leaves the bracket. Nothing where the root lies beyond `max`.
template <typename Function>
std::optional<double> SolveIncreasing(const Function& function, double start, double max) {
  if (!(function(max).first >= 0)) return std::nullopt;
  double low = 0, high = max, x = start;
  for (int iteration = 0; iteration < 100; ++iteration) {
    const auto [value, slope] = function(x);
    (value < 0 ? low : high) = x;
    double next = x - value / slope;
    if (!(low <= next && next <= high)) next = 0.5 * (low + high);
    const double step = std::abs(next - x);
    x = next;
    if (step <= 4e-16 * x) break;
  }
  return x;
}

}  // namespace parkade
