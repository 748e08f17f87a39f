#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace parkade {

/// What a surface is: the channels of Parkade's networks in their order (training/classes.py), and
/// what files number.
enum class SurfaceClass : std::uint8_t {
  kDrivable,
  kMarking,     ///< painted on what is drivable
  kPavement,    ///< paved, but not for cars; paved islands, too
  kVegetation,  ///< also soil and gravel, and what grows there
  kKerb,
  kVehicle,
  kPerson,
  kStructure,  ///< all else that stands, and the sky
  kOwnCar,
  kUnknown,
};
constexpr std::size_t kNumSurfaceClasses = 9;  ///< without kUnknown

constexpr std::array<std::string_view, kNumSurfaceClasses + 1> kSurfaceClassNames = {
    "drivable", "marking", "pavement",  "vegetation", "kerb",
    "vehicle",  "person",  "structure", "own_car",    "unknown"};

constexpr std::string_view NameOf(SurfaceClass surface) {
  return kSurfaceClassNames[static_cast<std::size_t>(surface)];
}

constexpr std::size_t kNumClassesForCars = 2;  ///< the first ones
constexpr bool IsForCars(SurfaceClass surface) { return surface <= SurfaceClass::kMarking; }

}  // namespace parkade
