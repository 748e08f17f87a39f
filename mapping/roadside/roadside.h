#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "mapping/ground/cell_finder.h"
#include "mapping/ground/driven_path.h"

namespace parkade {

/// What ends the free ground beside a driven path.
enum class RoadsideEnd {
  kUnseen,   ///< nothing is known of what follows
  kVehicle,  ///< something that images take for a vehicle
  kOther,    ///< a kerb, a pavement, a wall
};

/// What one place of a path has at one of its sides.
struct RoadsideSection {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();    ///< [m] in site, on the path
  Eigen::Vector2d outward = Eigen::Vector2d::Zero();  ///< unit, across the path to that side
  double free_width = 0;                              ///< [m] of free ground, from the path outward
  RoadsideEnd end = RoadsideEnd::kUnseen;

  Eigen::Vector2d At(double distance) const { return place.head<2>() + distance * outward; }
};

/// One side of one drive's path in steps of kStep along it. The side's own order is that of the
/// path, or against it, so that the roadside lies on the right.
struct Roadside {
  static constexpr double kStep = 0.2;    ///< [m] along the path
  static constexpr double kReach = 10.0;  ///< [m] beside it
  std::vector<RoadsideSection> sections;
};

/// Both sides of every path. O(length of the paths). In parallel, the same every time.
std::vector<Roadside> LookBeside(const CellFinder& cells, std::span<const DrivenPath> paths);

}  // namespace parkade
