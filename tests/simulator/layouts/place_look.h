#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "tests/simulator/common/mesh.h"
#include "tests/simulator/ground/road_look.h"
#include "tests/simulator/ground/season.h"

namespace parkade::simulator {

/// Of what the ground of a place is made, and how high its kerbs are.
struct PlaceLook {
  std::string family = "classic";
  double kerb_height = 0.12;  ///< [m]
  RoadLook road;
  std::array<Material, 3> kerbs;  ///< each stone is of one of them
  Material pavement,              ///< behind the kerbs of streets
      island,                     ///< on top of islands
      land;                       ///< all around
};

/// Looks are drawn per place from families of surfaces. `looks` is "classic", the one look of a
/// place of old; "known", for networks to learn from; "mixed", each surface of another known one;
/// or "unknown", families with kinds of surface that no known one has: nothing is trained on or
/// chosen by them. Throws Error{kUsage} for others.
PlaceLook LookOf(const std::string& looks, std::uint64_t seed);

/// The same with leaves or snow on all that is neither road nor kerb.
PlaceLook InSeason(PlaceLook look, Season season);

}  // namespace parkade::simulator
