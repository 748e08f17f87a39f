#pragma once

#include <string>

#include "tests/simulator/common/fault_options.h"
#include "tests/simulator/motion/driver_options.h"
#include "tests/simulator/render/image_sensor.h"
#include "tests/simulator/render/lens_options.h"
#include "tests/simulator/scenes/scene.h"
#include "tests/simulator/sensors/sensors.h"
#include "tests/simulator/vehicle/camera_clock.h"
#include "tests/simulator/vehicle/simulated_rig.h"

namespace parkade::simulator {

/// All that can be set about a drive.
struct SimulateOptions {
  std::string scene = "lot";
  int seed = 1;         ///< of everything that is left to chance, but for the place
  int place_seed = -1;  ///< of the place; -1: `seed`. Drives of one place have it in common
  int day = 0;          ///< of the place: other parked cars, other light
  std::string weather;  ///< dry, overcast, wet, dusk; empty: as the day wants it
  std::string looks = "classic";           ///< of what the ground is made (LookOf)
  std::string slot_marks = "usual";        ///< of a lot or street; also tees, corners (SlotMarks)
  std::string season = "usual";            ///< of a lot or street; also autumn, winter (Season)
  bool has_drains = false;                 ///< grates at kerbs and gutters across the ground
  double sun_elevation = 0;                ///< [degrees] 5 to 90; 0: as the place wants it
  bool has_own_car = true;                 ///< false: images show neither it nor its shadow
  int speed_bumps = 0;                     ///< of a lot, at most 4
  int traffic = 0;                         ///< cars that move, and as many people (see AddTraffic)
  double duration = 40;                    ///< [s] 10 to 3600; counts where drive.length is 0
  double relief = 1;                       ///< scales the ground's slopes
  double ground_texel = 0.01;              ///< [m] of painted asphalt
  bool semantic = false;                   ///< also write masks, one per image
  std::string semantic_kind = "drivable";  ///< what they show; also level, classes (Semantics)
  DriverOptions drive;
  RigOptions rig;
  SensorOptions sensors;
  CameraClockOptions cameras;
  LensOptions lens;
  ImageSensorOptions image;
  FaultOptions faults;

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("scene", scene);
    visit("seed", seed);
    visit("place_seed", place_seed);
    visit("day", day);
    visit("weather", weather);
    visit("looks", looks);
    visit("slot_marks", slot_marks);
    visit("season", season);
    visit("has_drains", has_drains);
    visit("sun_elevation", sun_elevation);
    visit("has_own_car", has_own_car);
    visit("speed_bumps", speed_bumps);
    visit("traffic", traffic);
    visit("duration", duration);
    visit("relief", relief);
    visit("ground_texel", ground_texel);
    visit("semantic", semantic);
    visit("semantic_kind", semantic_kind);
    visit("drive", drive);
    visit("rig", rig);
    visit("sensors", sensors);
    visit("cameras", cameras);
    visit("lens", lens);
    visit("image", image);
    visit("faults", faults);
  }
  void Validate() const;  ///< throws Error{kUsage}

  SceneOptions OfScene() const;
};

}  // namespace parkade::simulator
