#include "tests/simulator/drives/presets.h"

#include <algorithm>

namespace parkade::simulator {
namespace {

/// What an ordinary recording car is like: rigs a little off, cameras a little late.
SimulateOptions RealCar(const std::string& scene, int seed, double length) {
  SimulateOptions options;
  options.scene = scene;
  options.seed = seed;
  options.drive.length = length;
  options.drive.stops = {};
  options.semantic = true;
  options.traffic = scene == "street" ? 5 : 2;
  options.faults.extrinsic_rotation_deg = {0.12, 0.25, 0.25, 0.15};
  options.faults.extrinsic_translation_cm = {0.5, 1, 1, 0.5};
  options.faults.time_offsets = {0.004, -0.003, 0.006, 0.002};
  return options;
}

/// As in the paper's simulation: the calibration is known exactly.
SimulateOptions ExactCar(int seed, double length) {
  SimulateOptions options = RealCar("street", seed, length);
  options.faults = {};
  options.sensors.imu = "rt3000";
  options.sensors.gnss = "none";
  return options;
}

void AddSimulated(std::vector<Preset>& presets) {
  presets.push_back({"sim1", "street, exact rig, RT3000", ExactCar(101, 250)});
  presets.push_back({"sim2", "street, a stop of 10 s", ExactCar(102, 468)});
  presets.back().options.drive.stops = {10};
  presets.push_back({"sim3", "street, fast, long straights", ExactCar(103, 749)});
  presets.back().options.drive.max_speed = 7;
  presets.push_back({"sim4", "street, MEMS IMU, rolling start", ExactCar(104, 804)});
  presets.back().options.sensors.imu = "mems";
  presets.back().options.drive.rolling_start = 3;
}

void AddOutdoor(std::vector<Preset>& presets) {
  const auto add = [&](double length, const char* scene,
                       const char* character) -> SimulateOptions& {
    const int index = static_cast<int>(presets.size()) - 4;
    presets.push_back(
        {"out" + std::to_string(index), character, RealCar(scene, 200 + index, length)});
    return presets.back().options;
  };
  const auto occlude = [](SimulateOptions& options, int camera, double begin, double end,
                          const char* kind) {
    options.faults.occlusion = {camera, begin, end, kind};
  };
  add(498, "lot", "lot, rounds").sensors.gnss = "rtk";
  add(445, "lot", "lot, two stops of 20 s").drive.stops = {20, 20};
  occlude(add(521, "street", "street, mud on the rear camera for minutes"), 3, 20, 140, "mud");
  add(807, "street", "street, fast, long straights, crowds").drive.max_speed = 7;
  presets.back().options.traffic = 10;
  add(537, "lot", "lot full of moving cars and people").traffic = 12;
  occlude(add(514, "lot", "lot, right camera dark for a minute"), 2, 30, 90, "dark");
  add(448, "street", "street, wheel slip, no GNSS").sensors.gnss = "none";
  presets.back().options.faults.slip = {40, 43, 0.4};
  occlude(add(406, "lot", "lot, mud on the rear camera, RT3000"), 3, 0, 120, "mud");
  presets.back().options.sensors.imu = "rt3000";
  add(48, "lot", "lot, backs into a slot").drive.parks = true;
  add(415, "street", "street at dusk").weather = "dusk";
  add(486, "lot", "lot in the wet, both directions").weather = "wet";
  presets.back().options.drive.turns_around = true;
  add(44, "lot", "lot, short, rolling start").drive.rolling_start = 2.5;
  occlude(add(437, "lot", "lot, rear camera dark nearly all the way"), 3, 10, 600, "dark");
  add(341, "street", "street, stands for a minute").drive.stops = {60};
  add(517, "lot", "lot, overcast, the other way around, a mirror is knocked").drive.is_opposite =
      true;
  presets.back().options.weather = "overcast";
  presets.back().options.faults.mirror = {1, 60, 1.5};
  add(194, "lot", "lot, backs into a slot and leaves it").drive.parks = true;
  presets.back().options.drive.leaves_slot = true;
}

void AddIndoor(std::vector<Preset>& presets) {
  const double lengths[] = {421, 321, 563, 416, 723, 647};
  const char* const characters[] = {
      "garage, several decks",         "garage, a stop of 15 s",
      "garage, without wheels",        "garage, the other way around",
      "garage, all cameras dark once", "garage, gaps of IMU and images"};
  for (int i = 0; i < 6; ++i) {
    Preset preset{"in" + std::to_string(i), characters[i], RealCar("garage", 300 + i, lengths[i])};
    presets.push_back(preset);
  }
  const size_t first = presets.size() - 6;
  presets[first + 1].options.drive.stops = {15};
  presets[first + 2].options.sensors.has_wheels = false;
  presets[first + 3].options.drive.is_opposite = true;
  presets[first + 4].options.faults.darkness = {60, 63};
  presets[first + 5].options.faults.imu_gap = {80, 80.3};
  presets[first + 5].options.faults.image_gap = {-1, 120, 122};
}

/// Sessions of one place: other cars stand there, the light is another. One goes the other way
/// around, by the way that the others have come, even where all are cut short.
void AddSessions(std::vector<Preset>& presets, const char* scene, double length, int opposite_day) {
  constexpr int kNumSessions = 3;
  for (int day = 1; day <= kNumSessions; ++day) {
    const bool is_opposite = day == opposite_day;
    Preset preset{scene + std::string("-day") + std::to_string(day),
                  std::string("one place with the other ") + scene + "-day sessions" +
                      (is_opposite ? ", the other way around" : ""),
                  RealCar(scene, 399 + day, length)};
    preset.options.place_seed = 40;
    preset.options.day = day - 1;
    preset.options.drive.is_opposite = preset.options.drive.drives_last_part = is_opposite;
    presets.push_back(std::move(preset));
  }
}

void Shrink(double factor, double& begin, double& end) {
  begin *= factor;
  end *= factor;
}

}  // namespace

const std::vector<Preset>& Presets() {
  static const std::vector<Preset> presets = [] {
    std::vector<Preset> made;
    AddSimulated(made);
    AddOutdoor(made);
    AddIndoor(made);
    AddSessions(made, "lot", 300, 3);
    AddSessions(made, "garage", 350, 2);
    AddSessions(made, "street", 400, 2);
    return made;
  }();
  return presets;
}

const Preset* FindPreset(const std::string& name) {
  for (const Preset& preset : Presets())
    if (preset.name == name) return &preset;
  return nullptr;
}

SimulateOptions QuickForm(const SimulateOptions& options) {
  constexpr double kShare = 0.25, kShortest = 44, kLongest = 120;  // [m]
  SimulateOptions quick = options;
  quick.cameras.rate = 10;
  quick.rig.width = 640;
  quick.rig.height = 400;
  quick.ground_texel = std::max(quick.ground_texel, 0.02);
  if (options.drive.length == 0) {
    quick.duration = std::min(options.duration, 20.0);
    return quick;
  }
  quick.drive.length = std::min(options.drive.length,
                                std::clamp(kShare * options.drive.length, kShortest, kLongest));
  const double factor = quick.drive.length / options.drive.length;
  for (double& stop : quick.drive.stops) stop = std::min(stop, 3.0);
  FaultOptions& faults = quick.faults;
  faults.mirror.at *= factor;
  Shrink(factor, faults.occlusion.begin, faults.occlusion.end);
  Shrink(factor, faults.image_gap.begin, faults.image_gap.end);
  Shrink(factor, faults.time_jump.begin, faults.time_jump.end);
  Shrink(factor, faults.slip.begin, faults.slip.end);
  for (TimeWindow* window :
       {&faults.darkness, &faults.imu_gap, &faults.wheel_gap, &faults.gnss_gap})
    Shrink(factor, window->begin, window->end);
  return quick;
}

}  // namespace parkade::simulator
