#pragma once

#include <cstdint>

namespace parkade {

enum class GroundLabel : std::uint8_t {
  kUnknown,    ///< not visible, or hidden
  kGround,     ///< drivable
  kNotGround,  ///< something stands here, or the ground is not for driving
  kHidden,     ///< shortly behind that: of what stands there most often
  kBeyond,     ///< further behind: it says nothing of where one can drive
  kDoubtful,   ///< drivable or not, which cannot be told from here: it has colors only
};

}  // namespace parkade
