#pragma once

#include "core/option_about.h"

namespace parkade {

/// What is estimated of the cameras' calibration, and how far off the rig may be:
/// standard deviations of the prior.
struct CalibrationOptions {
  bool extrinsics = true;     ///< imu_from_camera of each camera
  bool time_offset = true;    ///< of each camera's stamps
  bool line_delay = true;     ///< of cameras whose rig declares one
  bool notice_jumps = true;   ///< a mount that turns during the drive is calibrated anew
  double rotation_deg = 1.0;  ///< per axis; less for a camera within 1 m of the IMU
  double translation_share =
      0.01;  ///< per axis, of the distance to the nearest camera (or IMU): small rigs are exact
  double translation = 0.03;        ///< [m] at most
  double time_offset_sigma = 0.01;  ///< [s]
  double line_delay_share = 0.2;    ///< of the declared line delay

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("extrinsics", extrinsics, OptionAbout{"The cameras' mounts are estimated."});
    visit("time_offset", time_offset, OptionAbout{"The cameras' time offsets are estimated."});
    visit("line_delay", line_delay,
          OptionAbout{"The line delay of rolling shutters is estimated where the rig gives one."});
    visit("rotation_deg", rotation_deg,
          OptionAbout{"A mount of the rig may be turned by this much (one sigma).", "deg", 0.001,
                      10});
    visit("translation", translation,
          OptionAbout{"A mount of the rig may be off by this much (one sigma).", "m", 0.0001, 1});
  }
  void Validate() const;  ///< throws Error{kUsage}
};

struct SmootherOptions {
  int window_nodes = 16;   ///< states estimated at a time; more: longer baselines, slower
  int landmarks = 120;     ///< seen at a time, shared by the cameras
  int max_iterations = 4;  ///< per node; the window starts near its optimum
  CalibrationOptions calibration;

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit(
        "window_nodes", window_nodes,
        OptionAbout{"The window holds this many states; more cost time and lose less.", "", 4, 64});
    visit("landmarks", landmarks,
          OptionAbout{"A solve uses this many landmarks at most.", "", 20, 1000});
    visit("max_iterations", max_iterations,
          OptionAbout{"A solve of the window takes this many steps at most.", "", 1, 50});
    visit("calibration", calibration);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

}  // namespace parkade
