#include "tests/simulator/scene.h"

#include <algorithm>

#include "core/error.h"
#include "tests/simulator/car_mesh.h"
#include "tests/simulator/lot_ground.h"
#include "tests/simulator/lot_objects.h"
#include "tests/simulator/random.h"
#include "tests/simulator/simulated_rig.h"

namespace parkade::simulator {
namespace {

Scene BuildLot(const SceneOptions& options) {
  const LotLayout layout = PlanLot(options.seed);
  const Terrain terrain(options.seed, options.relief);
  Scene scene{.layout = layout,
              .terrain = terrain,
              .sky = Sky(options.seed),
              .ground_colors = PaintLot(layout, options.ground_texel, options.seed),
              .ground = MakeLotGround(layout, terrain),
              .objects = {},
              .materials = {},
              .own_car = {}};
  scene.objects = MakeLotObjects(layout, terrain, options.seed, scene.materials);
  const Mesh car = MakeCar(kOwnCarStyle, Mix64(options.seed), scene.materials);
  scene.own_car.Append(car, {Eigen::Quaterniond::Identity(), {-RearAxleX(kOwnCarStyle), 0, 0}});
  return scene;
}

}  // namespace

const std::vector<std::string>& SceneNames() {
  static const std::vector<std::string> names = {"lot"};
  return names;
}

Scene BuildScene(const std::string& name, const SceneOptions& options) {
  std::string known;
  for (const std::string& scene : SceneNames()) known += (known.empty() ? "" : ", ") + scene;
  Require(std::find(SceneNames().begin(), SceneNames().end(), name) != SceneNames().end(), ErrorCode::kUsage,
          "there is no scene '" + name + "'; there are: " + known);
  return BuildLot(options);
}

}  // namespace parkade::simulator
