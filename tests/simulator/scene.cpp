#include "tests/simulator/scene.h"

#include "tests/simulator/car_mesh.h"
#include "tests/simulator/lot_ground.h"
#include "tests/simulator/lot_objects.h"
#include "tests/simulator/lot_place.h"
#include "tests/simulator/random.h"
#include "tests/simulator/simulated_rig.h"

namespace parkade::simulator {
namespace {

Scene BuildLot(const Place& place, const SceneOptions& options) {
  const LotLayout layout = PlanLot(options.seed);
  Scene scene{.place = place,
              .sky = Sky(options.seed),
              .ground_colors = {},
              .ground = MakeLotGround(layout, place.ground),
              .objects = {},
              .materials = {},
              .own_car = {}};
  scene.ground_colors.push_back(PaintLot(layout, options.ground_texel, options.seed));
  scene.objects = MakeLotObjects(layout, place.ground, options.seed, scene.materials);
  return scene;
}

}  // namespace

Scene BuildScene(const std::string& name, const SceneOptions& options) {
  const Place place = PlanPlace(name, options);
  Scene scene = BuildLot(place, options);
  const Mesh car = MakeCar(kOwnCarStyle, Mix64(options.seed), scene.materials);
  scene.own_car.Append(car, {Eigen::Quaterniond::Identity(), {-RearAxleX(kOwnCarStyle), 0, 0}});
  return scene;
}

}  // namespace parkade::simulator
