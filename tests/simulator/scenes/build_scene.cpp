#include "tests/simulator/scenes/build_scene.h"

#include "tests/simulator/common/random.h"
#include "tests/simulator/layouts/lot_ground.h"
#include "tests/simulator/layouts/lot_place.h"
#include "tests/simulator/layouts/plan_place.h"
#include "tests/simulator/scenes/garage_scene.h"
#include "tests/simulator/scenes/lot_objects.h"
#include "tests/simulator/scenes/street_scene.h"
#include "tests/simulator/vehicle/car_mesh.h"
#include "tests/simulator/vehicle/simulated_rig.h"

namespace parkade::simulator {
namespace {

Scene BuildLot(const Place& place, const SceneOptions& options) {
  const LotLayout layout = PlanLot(options);
  const PlaceLook look = InSeason(LookOf(options.looks, options.seed), SeasonOf(options.season));
  const Weather weather = WeatherOf(options);
  Scene scene{.place = place,
              .sky = Sky(options.seed + 7919 * static_cast<std::uint64_t>(options.day), weather,
                         options.sun_elevation),
              .ground = MakeLotGround(layout, place.ground)};
  scene.ground_colors.push_back(PaintLot(layout, look.road, options));
  Props props(scene.place.ground, options.seed, weather == Weather::kDusk, look, scene.materials);
  FurnishLot(layout, props);
  scene.objects = std::move(props.mesh());
  scene.lamps = LampField(props.lamps());
  scene.kerbs = std::move(props.kerbs());
  return scene;
}

void AddWeather(Weather weather, Scene& scene) {
  if (weather == Weather::kWet && scene.finish.empty())
    scene.finish.assign(scene.place.ground.sheets().size(), {.wetness = 1});
  scene.has_headlights = weather == Weather::kDusk || scene.IsIndoors();
  scene.usual_exposure = scene.IsIndoors()           ? 0.006
                         : weather == Weather::kDusk ? 0.009
                         : weather == Weather::kDry  ? 0.003
                                                     : 0.005;
}

}  // namespace

Scene BuildScene(const std::string& name, const SceneOptions& options) {
  const Place place = PlanPlace(name, options);  // refuses unknown names
  Scene scene = name == "garage"   ? BuildGarage(options)
                : name == "street" ? BuildStreet(options)
                                   : BuildLot(place, options);
  AddWeather(WeatherOf(options), scene);
  if (!options.has_own_car) return scene;
  const Mesh car = MakeCar(kOwnCarStyle, Mix64(options.seed), scene.materials);
  scene.own_car.Append(car, {Eigen::Quaterniond::Identity(), {-RearAxleX(kOwnCarStyle), 0, 0}});
  return scene;
}

}  // namespace parkade::simulator
