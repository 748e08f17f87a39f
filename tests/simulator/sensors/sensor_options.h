#pragma once

#include <string>

namespace parkade::simulator {

/// What the sensors are, and what they do wrong all the time. What goes wrong at times is in
/// FaultOptions.
struct SensorOptions {
  std::string imu = "mems";          ///< mems, rt3000
  double imu_rate = 100;             ///< [Hz]
  double imu_noise = 1;              ///< scales all errors of the IMU; 0 is an ideal one
  double wheel_scale_error = 0.005;  ///< of speed; unknown to the rig
  double wheel_noise = 1;            ///< scales the noise of speed and yaw rate
  double wheel_slips = 2;            ///< short slips per minute of hard acceleration and braking
  std::string gnss = "standard";     ///< standard, rtk, none
  double gnss_sigma = 0;             ///< [m] horizontal; 0 = as usual for the kind (1.5 or 0.02)
  double gnss_memory = 60;           ///< [s] of its slow errors (Gauss-Markov)
  double gnss_multipath = 1;         ///< jumps per minute; standard GNSS only
  bool has_wheels = true;

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("imu", imu);
    visit("imu_rate", imu_rate);
    visit("imu_noise", imu_noise);
    visit("wheel_scale_error", wheel_scale_error);
    visit("wheel_noise", wheel_noise);
    visit("wheel_slips", wheel_slips);
    visit("gnss", gnss);
    visit("gnss_sigma", gnss_sigma);
    visit("gnss_memory", gnss_memory);
    visit("gnss_multipath", gnss_multipath);
    visit("has_wheels", has_wheels);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

}  // namespace parkade::simulator
