#pragma once

#include <string>
#include <vector>

#include "tests/simulator/layouts/place.h"

namespace parkade::simulator {

/// The scenes there are.
const std::vector<std::string>& SceneNames();

/// The same options give the same place. Throws Error{kUsage} naming the scenes
/// there are for any other name.
Place PlanPlace(const std::string& name, const SceneOptions& options);

}  // namespace parkade::simulator
