#pragma once

#include <string>

#include "tests/simulator/scenes/scene.h"

namespace parkade::simulator {

/// The place of these options with all that is to be seen there. Throws as PlanPlace.
Scene BuildScene(const std::string& name, const SceneOptions& options);

}  // namespace parkade::simulator
