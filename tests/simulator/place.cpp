#include "tests/simulator/place.h"

#include <algorithm>

#include "core/error.h"
#include "tests/simulator/lot_place.h"

namespace parkade::simulator {

const std::vector<std::string>& SceneNames() {
  static const std::vector<std::string> names = {"lot"};
  return names;
}

Place PlanPlace(const std::string& name, const SceneOptions& options) {
  std::string known;
  for (const std::string& scene : SceneNames()) known += (known.empty() ? "" : ", ") + scene;
  Require(std::find(SceneNames().begin(), SceneNames().end(), name) != SceneNames().end(), ErrorCode::kUsage,
          "there is no scene '" + name + "'; there are: " + known);
  return MakeLotPlace(PlanLot(options.seed), options);
}

}  // namespace parkade::simulator
