#pragma once

#include "tests/simulator/scenes/scene.h"

namespace parkade::simulator {

/// The street of these options: road, kerbs, pavements, houses, trees, lamps and parked cars.
Scene BuildStreet(const SceneOptions& options);

}  // namespace parkade::simulator
