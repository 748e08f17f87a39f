#pragma once

#include <algorithm>

namespace parkade {

/// The 99 % quantile of chi^2 with 1 to 6 degrees of freedom.
inline double ChiSquared99(int degrees_of_freedom) {
  constexpr double kQuantiles[] = {6.6349, 9.2103, 11.3449, 13.2767, 15.0863, 16.8119};
  return kQuantiles[std::clamp(degrees_of_freedom, 1, 6) - 1];
}

}  // namespace parkade
