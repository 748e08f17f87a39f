#include "tests/simulator/drives/simulate_options.h"

#include "core/error.h"
#include "tests/simulator/ground/season.h"
#include "tests/simulator/layouts/place_look.h"
#include "tests/simulator/layouts/slot_marks.h"

namespace parkade::simulator {

void SimulateOptions::Validate() const {
  Require(seed >= 0 && place_seed >= -1, ErrorCode::kUsage, "the seed must not be negative");
  Require(day >= 0 && day <= 1000, ErrorCode::kUsage, "the day must be 0 to 1000");
  Require(speed_bumps >= 0 && speed_bumps <= 4, ErrorCode::kUsage,
          "the speed bumps must be 0 to 4");
  Require(sun_elevation == 0 || (sun_elevation >= 5 && sun_elevation <= 90), ErrorCode::kUsage,
          "the sun's elevation must be 5 to 90 degrees");
  Require(traffic >= 0 && traffic <= 50, ErrorCode::kUsage, "the traffic must be 0 to 50");
  Require(duration >= 10 && duration <= 3600, ErrorCode::kUsage,
          "the duration must be 10 to 3600 s");
  Require(relief >= 0 && relief <= 3, ErrorCode::kUsage, "the relief must be 0 to 3");
  Require(ground_texel >= 0.002 && ground_texel <= 0.2, ErrorCode::kUsage,
          "the ground's texels must be 0.002 to 0.2 m");
  Require(semantic_kind == "drivable" || semantic_kind == "level" || semantic_kind == "classes",
          ErrorCode::kUsage, "semantic_kind must be drivable, level or classes");
  LookOf(looks, 1);
  SlotMarksOf(slot_marks);
  SeasonOf(season);
  drive.Validate();
  rig.Validate();
  sensors.Validate();
  cameras.Validate();
  lens.Validate();
  image.Validate();
  faults.Validate();
}

SceneOptions SimulateOptions::OfScene() const {
  SceneOptions scene_options;
  scene_options.seed = static_cast<std::uint64_t>(place_seed < 0 ? seed : place_seed);
  scene_options.relief = relief;
  scene_options.ground_texel = ground_texel;
  scene_options.day = day;
  scene_options.speed_bumps = speed_bumps;
  scene_options.weather = weather;
  scene_options.looks = looks;
  scene_options.slot_marks = slot_marks;
  scene_options.season = season;
  scene_options.has_drains = has_drains;
  scene_options.sun_elevation = sun_elevation;
  scene_options.has_own_car = has_own_car;
  return scene_options;
}

}  // namespace parkade::simulator
