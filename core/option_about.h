#pragma once

#include <limits>

namespace parkade {

/// What a user must know of an option; `VisitFields` hands it on with the field.
struct OptionAbout {
  const char* sentence;                                     ///< what it does
  const char* unit = "";                                    ///< "" without one
  double least = -std::numeric_limits<double>::infinity();  ///< a smaller number is refused
  double most = std::numeric_limits<double>::infinity();
};

}  // namespace parkade
