#pragma once

#include <Eigen/Core>
#include <vector>

#include "mapping/roadside/roadside.h"

namespace parkade {

/// What one place of a strip beside the kerb, as wide as a car, holds.
enum class LaneState {
  kUnseen,
  kFree,     ///< bare ground up to the kerb
  kVehicle,  ///< one that stands parallel to the kerb
  kBlocked,  ///< something else, or no kerb
};

/// The strip along a kerb in which cars may stand one behind the other, in steps of kStep along its
/// middle, the kerb on the right.
struct ParkingLane {
  static constexpr double kStep = 0.2;   ///< [m] along the lane
  static constexpr double kWidth = 2.0;  ///< [m]

  std::vector<Eigen::Vector3d> places;  ///< [m] in site, in its middle; heights are the path's
  std::vector<LaneState> states;        ///< of each place
  std::vector<double> path_distances;   ///< [m] from each place to the path beside it
};

/// The lane beside a path. Where the kerb lies is what most places nearby agree in, of which some
/// show the kerb itself and others the flanks of cars that stand before it. Places where nothing
/// tells are kUnseen. O(places).
ParkingLane FindParkingLane(const Roadside& roadside);

}  // namespace parkade
