#pragma once

#include "slam/factors/wheel_preintegration.h"
#include "slam/odometry/standstill_detector.h"
#include "slam/smoother/smoother_options.h"
#include "slam/tracking/cross_camera_matcher.h"
#include "slam/tracking/feature_tracker.h"

namespace parkade {

/// When the smoother gets a new state.
struct KnotOptions {
  double interval = 0.1;        ///< [s] between knots of a moving car, at least
  double slow_interval = 0.2;   ///< [s] at most, while it moves and turns little
  double distance = 0.25;       ///< [m] after which the next knot is due
  double rotation = 0.05;       ///< [rad] likewise
  double still_interval = 1.0;  ///< [s] while the car stands

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("interval", interval);
    visit("slow_interval", slow_interval);
    visit("distance", distance);
    visit("rotation", rotation);
    visit("still_interval", still_interval);
  }
  void Validate() const;
};

struct OdometryOptions {
  bool use_wheels = true;             ///< false: as if the log had none
  double output_interval = 0.025;     ///< [s] at most between two states of the trajectory
  double keyframe_distance = 0.5;     ///< [m] per camera
  double keyframe_rotation_deg = 10;  ///< per camera
  double max_start_time = 3.0;        ///< [s] of motion used for one attempt to initialise without wheels
  bool smooth_backwards = true;       ///< let what is learned later correct what was estimated before
  bool match_across_cameras = true;   ///< stereo observations where views overlap
  KnotOptions knots;
  SmootherOptions smoother;
  StandstillOptions standstill;
  WheelNoise wheels;
  FeatureTrackerOptions tracker;
  CrossCameraOptions cross_camera;

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("use_wheels", use_wheels);
    visit("output_interval", output_interval);
    visit("keyframe_distance", keyframe_distance);
    visit("keyframe_rotation_deg", keyframe_rotation_deg);
    visit("max_start_time", max_start_time);
    visit("smooth_backwards", smooth_backwards);
    visit("match_across_cameras", match_across_cameras);
    visit("knots", knots);
    visit("smoother", smoother);
    visit("standstill", standstill);
    visit("wheels", wheels);
    visit("tracker", tracker);
    visit("cross_camera", cross_camera);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

}  // namespace parkade
