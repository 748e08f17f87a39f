#pragma once

#include <vector>

#include "tests/simulator/layouts/garage_style.h"
#include "tests/simulator/layouts/lot_layout.h"
#include "tests/simulator/layouts/place.h"
#include "tests/simulator/motion/ramp_profile.h"

namespace parkade::simulator {

/// The plan of a building of equal decks. Each has the plan of a lot over
/// [0, length] x [0, width], and a strip to the north of it. In the strip a straight
/// ramp climbs east from deck to deck; at the east wall a half circle climbs from the
/// southern aisle to the northern aisle of the next deck. To the west of deck 0 lies a
/// forecourt in the open.
struct GarageLayout {
  static constexpr double kSlab = 0.25;     ///< [m] thickness of floors
  static constexpr double kStrip = 5;       ///< [m] width of the strip
  static constexpr double kForecourt = 30;  ///< [m] length
  static constexpr double kCurveHalfWidth = 2.5;
  static constexpr double kWallHalf = 0.1;  ///< [m] of the thickness of walls
  static constexpr double kGateHalf = 2.9;  ///< [m] of the width of gates
  static constexpr double kStripWallEnd =
      9.3;  ///< [m] from either end, where the strip's wall stops

  std::vector<LotLayout> decks;  ///< the same but for the cars
  double storey = 2.9;           ///< [m] from deck to deck
  double length = 0, width = 0;
  RampProfile straight, curve;
  double ramp_from = 0, ramp_to = 0;  ///< x of the straight ramp
  double curve_y = 0, curve_radius = 0;
  // On every deck:
  std::vector<Rectangle> pillars;
  std::vector<Rectangle> cores;         ///< stairs, lifts and rooms, from floor to ceiling
  std::vector<Rectangle> median_walls;  ///< between the rows in the middle
  double median_wall = 0;               ///< [m] their height
  std::vector<Rectangle> lamp_feet;     ///< of the lamps on the forecourt
  bool is_counter = false;              ///< see GarageMeasures
  GarageStyle style;

  int num_decks() const { return static_cast<int>(decks.size()); }
  int num_ramps() const { return num_decks() - 1; }
  /// Whether a wall stands on a point of a sheet of the ground.
  bool IsUnderWall(size_t sheet, const Eigen::Vector2d& point) const;
  double top() const { return storey * num_decks(); }  ///< [m] of the roof

  // Sheets of the ground: decks, forecourt, straight ramps, half circles.
  size_t ForecourtSheet() const { return decks.size(); }
  size_t StraightSheet(int from_deck) const {
    return decks.size() + 1 + static_cast<size_t>(from_deck);
  }
  size_t CurveSheet(int from_deck) const { return StraightSheet(from_deck + num_ramps()); }
};

GarageLayout PlanGarage(std::uint64_t seed, int day);

}  // namespace parkade::simulator
