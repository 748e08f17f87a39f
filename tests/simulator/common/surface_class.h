#pragma once

#include <cstdint>

namespace parkade::simulator {

/// What a surface is, as masks of classes count it.
enum class SurfaceClass : std::uint8_t {
  kDrivable,
  kMarking,  ///< painted on what is drivable
  kPavement,
  kVegetation,  ///< also soil, gravel, and what grows there
  kKerb,
  kVehicle,  ///< also the ground that it stands on
  kPerson,
  kStructure,  ///< all else that stands, and the sky
  kOwnCar,
};
constexpr int kNumSurfaceClasses = 9;

}  // namespace parkade::simulator
