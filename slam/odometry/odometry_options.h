#pragma once

#include "core/option_about.h"
#include "slam/factors/wheel_preintegration.h"
#include "slam/odometry/standstill_detector.h"
#include "slam/smoother/smoother_options.h"
#include "slam/tracking/cross_camera_matcher.h"
#include "slam/tracking/feature_tracker.h"

namespace parkade {

/// When the smoother gets a new state.
struct NodeOptions {
  double interval = 0.1;        ///< [s] at least, between nodes of a moving car
  double slow_interval = 0.2;   ///< [s] at most, while it moves and turns little
  double distance = 0.25;       ///< [m] after which the next node is due
  double rotation = 0.05;       ///< [rad] after which the next node is due
  double still_interval = 1.0;  ///< [s] while the car stands
  void Validate() const;
};

struct OdometryOptions {
  bool use_wheels = true;             ///< false: as if the log had none
  double output_interval = 0.025;     ///< [s] at most between two states of the trajectory
  double keyframe_distance = 0.5;     ///< [m] per camera
  double keyframe_rotation_deg = 10;  ///< per camera
  double max_start_time = 3.0;  ///< [s] of motion used for one attempt to initialize without wheels
  bool smooth_backwards = true;  ///< let what is learned later correct what was estimated before
  bool match_across_cameras = true;  ///< stereo observations where views overlap
  NodeOptions nodes;
  SmootherOptions smoother;
  StandstillOptions standstill;
  WheelNoise wheels;
  FeatureTrackerOptions tracker;
  CrossCameraOptions cross_camera;

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("use_wheels", use_wheels, OptionAbout{"Wheel odometry is used where the log has it."});
    visit("output_interval", output_interval,
          OptionAbout{"States of the trajectory are this far apart.", "s", 0.005, 0.05});
    visit("max_start_time", max_start_time,
          OptionAbout{
              "The odometry looks this long for a first state before it begins the search anew.",
              "s", 0.5, 60});
    visit("smoother", smoother);
    visit("tracker", tracker);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

}  // namespace parkade
