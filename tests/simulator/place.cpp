#include "tests/simulator/place.h"

#include <algorithm>

#include "core/error.h"
#include "tests/simulator/garage_layout.h"
#include "tests/simulator/lot_place.h"
#include "tests/simulator/random.h"

namespace parkade::simulator {

Weather WeatherOf(const SceneOptions& options) {
  const std::vector<std::string> names = {"dry", "overcast", "wet", "dusk"};
  if (options.weather.empty())
    return options.day == 0
               ? Weather::kDry
               : static_cast<Weather>(Random(options.seed, 0xda7 + static_cast<std::uint64_t>(options.day)).Index(4));
  const auto found = std::find(names.begin(), names.end(), options.weather);
  Require(found != names.end(), ErrorCode::kUsage,
          "there is no weather '" + options.weather + "'; there are: dry, overcast, wet, dusk");
  return static_cast<Weather>(found - names.begin());
}

const std::vector<std::string>& SceneNames() {
  static const std::vector<std::string> names = {"lot", "garage"};
  return names;
}

Place PlanPlace(const std::string& name, const SceneOptions& options) {
  std::string known;
  for (const std::string& scene : SceneNames()) known += (known.empty() ? "" : ", ") + scene;
  Require(std::find(SceneNames().begin(), SceneNames().end(), name) != SceneNames().end(), ErrorCode::kUsage,
          "there is no scene '" + name + "'; there are: " + known);
  if (name == "garage") return MakeGaragePlace(PlanGarage(options.seed, options.day), options);
  return MakeLotPlace(PlanLot(options.seed, options.day), options);
}

}  // namespace parkade::simulator
