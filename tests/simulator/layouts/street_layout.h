#pragma once

#include <vector>

#include "tests/simulator/ground/road_field.h"
#include "tests/simulator/layouts/lot_layout.h"
#include "tests/simulator/layouts/place.h"

namespace parkade::simulator {

/// The plan of a block in a town: a street around it and one across it, with a lane each way
/// and cars parked at both kerbs. Driving is on the right.
struct StreetLayout {
  static constexpr double kHalfWidth = 5.3;    ///< [m] kerb to middle
  static constexpr double kLane = 1.6;         ///< [m] middle of a lane to the middle of the street
  static constexpr double kParking = 4.3;      ///< [m] middle of parked cars
  static constexpr double kPavement = 3.2;     ///< [m] width
  static constexpr double kCornerRadius = 14;  ///< [m] of the middle of the street

  std::vector<Eigen::Vector2d> corners;  ///< of the middle of the street around, counter-clockwise
  RoadField::Line loop, cross;  ///< middles of the streets, in steps of a meter; cross runs north
  Eigen::Vector2d south_junction,
      north_junction;  ///< where the cross street's middle meets the others
  RoadField field;
  struct Wave {
    Eigen::Vector2d wave_vector;
    double amplitude = 0, phase = 0;
  };
  std::vector<Wave> hills;
  std::vector<Rectangle> slots;  ///< at the kerbs
  std::vector<ParkedCar> cars;
  std::vector<Rectangle> crossings;  ///< zebras; x along the street
};

StreetLayout PlanStreet(std::uint64_t seed, int day);

}  // namespace parkade::simulator
