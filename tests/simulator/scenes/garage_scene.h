#pragma once

#include "tests/simulator/scenes/scene.h"

namespace parkade::simulator {

/// The garage of these options: decks, ramps, walls, pillars, lamps, pipes, signs and parked cars.
Scene BuildGarage(const SceneOptions& options);

}  // namespace parkade::simulator
