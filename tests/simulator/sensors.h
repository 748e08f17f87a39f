#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/drive_log.h"
#include "core/geo.h"
#include "core/rig.h"
#include "tests/simulator/motion.h"

namespace parkade::simulator {

/// What the sensors do wrong. Defaults: a MEMS IMU, ordinary wheels, standard GNSS.
struct SensorOptions {
  double imu_noise = 1;              ///< scales white noise, bias and random walk; 0 is an ideal IMU
  double wheel_scale_error = 0.005;  ///< of speed; unknown to the rig
  double wheel_noise = 1;            ///< scales the noise of speed and yaw rate
  std::string gnss = "standard";     ///< standard, rtk, none
  double gnss_sigma = 0;             ///< [m] horizontal; 0 = as usual for the kind (0.8 or 0.02)
  bool has_wheels = true;

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("imu_noise", imu_noise);
    visit("wheel_scale_error", wheel_scale_error);
    visit("wheel_noise", wheel_noise);
    visit("gnss", gnss);
    visit("gnss_sigma", gnss_sigma);
    visit("has_wheels", has_wheels);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

inline constexpr double kGravity = 9.80665;  ///< [m/s^2]

/// When the simulated clock's second 0 is.
Timestamp DriveEpoch(std::uint64_t seed);

/// What an ideal IMU measures: angular velocity and specific force in imu.
ImuSample IdealImuSample(const Motion& motion, const Rigid3& body_from_imu, Timestamp epoch, Timestamp time);

// Streams over the whole motion, in order of time. White noise, Gauss-Markov
// errors and biases have random numbers of their own per stream.
std::vector<ImuSample> SimulateImu(const Motion& motion, const Rig& rig, const SensorOptions& options,
                                   std::uint64_t seed);
std::vector<WheelSample> SimulateWheels(const Motion& motion, const SensorOptions& options, std::uint64_t seed);
std::vector<GnssFix> SimulateGnss(const Motion& motion, const Rig& rig, const SiteDatum& datum,
                                  const SensorOptions& options, std::uint64_t seed);

/// When each camera takes its pictures: the rate is common, the phase is each camera's own.
struct CameraClockOptions {
  double rate = 10;             ///< [Hz]
  double jitter = 0.0008;       ///< [s] standard deviation of the intervals' ends, cut at three times
  double drop_probability = 0;  ///< share of pictures that get lost

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("rate", rate);
    visit("jitter", jitter);
    visit("drop_probability", drop_probability);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

struct ScheduledFrame {
  Timestamp time;  ///< middle of the exposure of the middle row
  size_t camera = 0;
};

/// Pictures of all cameras in order of time, between `margin` [s] after the start and before the end.
std::vector<ScheduledFrame> ScheduleFrames(const Motion& motion, size_t num_cameras, const CameraClockOptions& options,
                                           double margin, std::uint64_t seed);

}  // namespace parkade::simulator
