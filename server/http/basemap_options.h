#pragma once

#include <string>

namespace parkade {

/// What the viewer draws below the outlines of sites.
struct BasemapOptions {
  std::string source;       ///< a file of PMTiles 3, or tiles by "https://HOST/{z}/{x}/{y}.png"
  std::string attribution;  ///< whom the map is by; most licenses ask for it
};

}  // namespace parkade
