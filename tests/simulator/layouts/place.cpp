#include "tests/simulator/layouts/place.h"

#include <algorithm>

#include "core/error.h"
#include "tests/simulator/common/random.h"

namespace parkade::simulator {

Weather WeatherOf(const SceneOptions& options) {
  const std::vector<std::string> names = {"dry", "overcast", "wet", "dusk"};
  if (options.weather.empty())
    return options.day == 0
               ? Weather::kDry
               : static_cast<Weather>(
                     Random(options.seed, 0xda7 + static_cast<std::uint64_t>(options.day))
                         .Index(4));
  const auto found = std::find(names.begin(), names.end(), options.weather);
  Require(found != names.end(), ErrorCode::kUsage,
          "there is no weather '" + options.weather + "'; there are: dry, overcast, wet, dusk");
  return static_cast<Weather>(found - names.begin());
}

std::vector<Eigen::Vector3d> WalkAround(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                                        double apart, const Ground& ground, double above,
                                        double near_z) {
  const Eigen::Vector2d along = (to - from).normalized(), left(-along.y(), along.x());
  const int num_steps = 1 + static_cast<int>((to - from).norm() / 2);
  std::vector<Eigen::Vector3d> walk;
  for (const double side : {-0.5, 0.5})
    for (int i = 0; i <= num_steps; ++i) {
      const double share = static_cast<double>(side < 0 ? i : num_steps - i) / num_steps;
      const Eigen::Vector2d at = from + (to - from) * share + side * apart * left;
      walk.emplace_back(at.x(), at.y(), ground.Height(at, near_z) + above);
    }
  return walk;
}

}  // namespace parkade::simulator
