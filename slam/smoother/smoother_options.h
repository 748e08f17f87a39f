#pragma once

namespace parkade {

/// How still a car stands: standard deviations over one interval.
struct StandstillNoise {
  double rotation = 2e-4;  ///< [rad]
  double position = 5e-4;  ///< [m]
  double velocity = 2e-3;  ///< [m/s]

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("rotation", rotation);
    visit("position", position);
    visit("velocity", velocity);
  }
  void Validate() const;
};

/// What is estimated of the cameras' calibration, and how far off the rig may be:
/// standard deviations of the prior.
struct CalibrationOptions {
  bool extrinsics = true;           ///< imu_from_camera of each camera
  bool time_offset = true;          ///< of each camera's stamps
  bool line_delay = true;           ///< of cameras whose rig declares one
  bool notice_jumps = true;         ///< a mount that turns during the drive is calibrated anew
  double rotation_deg = 1.0;        ///< per axis; less for a camera within 1 m of the IMU
  double translation_share = 0.01;  ///< per axis, of the distance to the nearest camera (or IMU): small rigs are exact
  double translation = 0.03;        ///< [m] at most
  double time_offset_sigma = 0.01;  ///< [s]
  double line_delay_share = 0.2;    ///< of the declared line delay

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("extrinsics", extrinsics);
    visit("time_offset", time_offset);
    visit("line_delay", line_delay);
    visit("notice_jumps", notice_jumps);
    visit("rotation_deg", rotation_deg);
    visit("translation_share", translation_share);
    visit("translation", translation);
    visit("time_offset_sigma", time_offset_sigma);
    visit("line_delay_share", line_delay_share);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

struct SmootherOptions {
  int window_knots = 16;            ///< states estimated at a time; more: longer baselines, slower
  int landmarks = 120;              ///< seen at a time, shared by the cameras
  int max_iterations = 4;           ///< per knot; the window starts near its optimum
  int start_iterations = 15;        ///< until the window is full for the first time
  double robust_width = 2.0;        ///< [sigma] Cauchy loss of bearings
  double wheel_robust_width = 2.0;  ///< [sigma] Cauchy loss of wheels: slip
  double max_bearing_error = 5.0;   ///< [sigma] a bearing further off is left out
  double min_distance = 0.3;        ///< [m] landmarks nearer are the car itself or nonsense
  bool estimate_wheel_scale = true;
  double wheel_scale_sigma = 0.01;  ///< of the tyres' radius before the drive tells
  bool scale_camera_noise = true;   ///< per camera, from its residuals
  StandstillNoise standstill;
  CalibrationOptions calibration;

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("window_knots", window_knots);
    visit("landmarks", landmarks);
    visit("max_iterations", max_iterations);
    visit("start_iterations", start_iterations);
    visit("robust_width", robust_width);
    visit("wheel_robust_width", wheel_robust_width);
    visit("max_bearing_error", max_bearing_error);
    visit("min_distance", min_distance);
    visit("estimate_wheel_scale", estimate_wheel_scale);
    visit("wheel_scale_sigma", wheel_scale_sigma);
    visit("scale_camera_noise", scale_camera_noise);
    visit("standstill", standstill);
    visit("calibration", calibration);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

}  // namespace parkade
