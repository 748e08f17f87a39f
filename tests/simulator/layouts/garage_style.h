#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "tests/simulator/common/color.h"
#include "tests/simulator/layouts/lot_layout.h"

namespace parkade::simulator {

/// How one garage differs from another in its plan; its decks do not differ.
struct GarageMeasures {
  LotMeasures deck;
  double storey = 2.9;       ///< [m] from deck to deck
  double ramp_share = 0.5;   ///< where in the strip the straight ramp lies: 0 far west, 1 far east
  int slots_per_pillar = 3;  ///< between two pillars
  Eigen::Vector2d pillar_half = {0.16, 0.35};  ///< [m] half its sides
  double pillar_inset = 1.7;  ///< [m] from the middle of the slots toward the aisle
  double median_wall = 0;     ///< [m] height of the wall between the rows in the middle; 0: none
  bool is_counter = false;    ///< up the straight ramps and down the half circles
};

GarageMeasures MeasureGarage(std::uint64_t seed);

enum class PillarPaint { kBands, kFoot, kRing, kFull };

/// How one garage differs from another in its looks.
struct GarageStyle {
  Color paint = Gray(0.2f);   ///< of walls at the foot, doors and some pillars
  double paint_height = 0.9;  ///< [m]
  Color concrete = Gray(0.34f), ceiling = Gray(0.42f), pipe = Gray(0.3f);
  PillarPaint pillars = PillarPaint::kBands;
  bool has_bays_named = false;             ///< boards on the pillars
  double lamp_step = 6.2, lamp_aside = 0;  ///< [m] between lamps over an aisle, and from its middle
  bool lamps_lie_across = false;
  double lamp_strength = 1, lamp_warmth = 0;  ///< the latter 0..1: from white to yellow
  double pipe_aside = 2.1;                    ///< [m] from the middle of the aisle
  double poster_step = 5;                     ///< [m] on average
};

GarageStyle StyleOfGarage(std::uint64_t seed);

}  // namespace parkade::simulator
