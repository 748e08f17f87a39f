#include "tests/simulator/layouts/plan_place.h"

#include <algorithm>

#include "core/error.h"
#include "tests/simulator/layouts/garage_layout.h"
#include "tests/simulator/layouts/garage_place.h"
#include "tests/simulator/layouts/lot_layout.h"
#include "tests/simulator/layouts/lot_place.h"
#include "tests/simulator/layouts/street_place.h"

namespace parkade::simulator {

const std::vector<std::string>& SceneNames() {
  static const std::vector<std::string> names = {"lot", "garage", "street"};
  return names;
}

Place PlanPlace(const std::string& name, const SceneOptions& options) {
  std::string known;
  for (const std::string& scene : SceneNames()) known += (known.empty() ? "" : ", ") + scene;
  Require(std::find(SceneNames().begin(), SceneNames().end(), name) != SceneNames().end(),
          ErrorCode::kUsage, "there is no scene '" + name + "'; there are: " + known);
  if (name == "garage") return MakeGaragePlace(PlanGarage(options.seed, options.day), options);
  if (name == "street") return MakeStreetPlace(PlanStreet(options.seed, options.day), options);
  return MakeLotPlace(PlanLot(options), options);
}

}  // namespace parkade::simulator
