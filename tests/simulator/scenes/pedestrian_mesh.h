#pragma once

#include "tests/simulator/common/random.h"
#include "tests/simulator/scenes/mover.h"

namespace parkade::simulator {

/// Adds somebody who walks: trunk, head and arms, and two legs that swing with the
/// speed [m/s]. `pose`: on the ground, x ahead.
void AddPedestrian(Random& random, const std::function<Rigid3(double)>& pose, double speed,
                   Movers& movers, std::vector<Material>& materials);

}  // namespace parkade::simulator
