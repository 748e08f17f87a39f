#include "tests/simulator/sensors.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "tests/simulator/random.h"

namespace parkade::simulator {
namespace {

constexpr double kImuRate = 100, kWheelRate = 100, kGnssRate = 5;  // [Hz]

Eigen::Vector3d NormalVector(Random& random) {
  const double x = random.Normal(), y = random.Normal(), z = random.Normal();
  return {x, y, z};
}

/// Times from `phase` [s] on at `rate`, up to the end of the motion.
std::vector<Timestamp> Ticks(const Motion& motion, double rate, double phase, std::uint64_t seed) {
  std::vector<Timestamp> ticks;
  for (int i = 0;; ++i) {
    const double time = phase + i / rate;
    if (time > motion.Duration()) return ticks;
    ticks.push_back(DriveEpoch(seed) + time);
  }
}

}  // namespace

void SensorOptions::Validate() const {
  Require(gnss == "standard" || gnss == "rtk" || gnss == "none", ErrorCode::kUsage,
          "GNSS is 'standard', 'rtk' or 'none', not '" + gnss + "'");
  Require(imu_noise >= 0 && wheel_noise >= 0 && gnss_sigma >= 0, ErrorCode::kUsage, "noises must not be negative");
  Require(std::abs(wheel_scale_error) < 0.5, ErrorCode::kUsage, "the wheels' scale error must be less than 0.5");
}

void CameraClockOptions::Validate() const {
  Require(rate > 0 && rate <= 120, ErrorCode::kUsage, "the cameras' rate must be above 0 and at most 120 Hz");
  Require(jitter >= 0 && 8 * jitter < 1 / rate, ErrorCode::kUsage,
          "the cameras' jitter must be less than an eighth of their interval");
  Require(drop_probability >= 0 && drop_probability < 1, ErrorCode::kUsage,
          "the drop probability must be 0 or more and below 1");
}

Timestamp DriveEpoch(std::uint64_t seed) {
  constexpr std::int64_t kNewYear2026 = 1'767'225'600, kSecond = 1'000'000'000;
  return {(kNewYear2026 + static_cast<std::int64_t>(seed % 8760) * 3600) * kSecond};
}

ImuSample IdealImuSample(const Motion& motion, const Rigid3& body_from_imu, Timestamp epoch, Timestamp time) {
  const MotionState state = motion.At(time - epoch);
  const Eigen::Vector3d& w = state.angular_velocity_in_body;
  const Eigen::Vector3d& lever = body_from_imu.translation;
  const Eigen::Quaterniond body_from_world = state.world_from_body.rotation.conjugate();
  const Eigen::Vector3d upward(0, 0, kGravity);
  const Eigen::Vector3d force_in_body = body_from_world * (state.acceleration_in_world + upward) +
                                        state.angular_acceleration_in_body.cross(lever) + w.cross(w.cross(lever));
  const Eigen::Quaterniond imu_from_body = body_from_imu.rotation.conjugate();
  return {time, imu_from_body * w, imu_from_body * force_in_body};
}

std::vector<ImuSample> SimulateImu(const Motion& motion, const Rig& rig, const SensorOptions& options,
                                   std::uint64_t seed) {
  Random random(seed, 0x14);
  const double scale = options.imu_noise, root_rate = std::sqrt(kImuRate);
  Eigen::Vector3d gyroscope_bias = scale * 0.004 * NormalVector(random);
  Eigen::Vector3d accelerometer_bias = scale * 0.06 * NormalVector(random);
  std::vector<ImuSample> samples;
  for (const Timestamp time : Ticks(motion, kImuRate, 0.0013, seed)) {
    ImuSample sample = IdealImuSample(motion, rig.body_from_imu, DriveEpoch(seed), time);
    gyroscope_bias += scale * rig.imu.gyroscope_random_walk / root_rate * NormalVector(random);
    accelerometer_bias += scale * rig.imu.accelerometer_random_walk / root_rate * NormalVector(random);
    sample.angular_velocity +=
        gyroscope_bias + scale * rig.imu.gyroscope_noise_density * root_rate * NormalVector(random);
    sample.linear_acceleration +=
        accelerometer_bias + scale * rig.imu.accelerometer_noise_density * root_rate * NormalVector(random);
    samples.push_back(sample);
  }
  return samples;
}

std::vector<WheelSample> SimulateWheels(const Motion& motion, const SensorOptions& options, std::uint64_t seed) {
  Random random(seed, 0x3e);
  const double yaw_scale = 1 + 0.004 * options.wheel_noise * random.Normal();
  std::vector<WheelSample> samples;
  for (const Timestamp time : Ticks(motion, kWheelRate, 0.0047, seed)) {
    const MotionState state = motion.At(time - DriveEpoch(seed));
    const double speed = (state.world_from_body.rotation.conjugate() * state.velocity_in_world).x();
    // Wheels that stand give no pulses: no speed, and no noise either.
    const double rolling = options.wheel_noise * std::min(1.0, std::abs(speed) / 0.2);
    WheelSample sample{time, speed * (1 + options.wheel_scale_error), state.angular_velocity_in_body.z() * yaw_scale};
    sample.forward_speed += rolling * (0.012 + 0.002 * std::abs(speed)) * random.Normal();
    sample.yaw_rate += rolling * 0.006 * random.Normal();
    if (std::abs(speed) < 1e-3) sample.forward_speed = sample.yaw_rate = 0;
    samples.push_back(sample);
  }
  return samples;
}

std::vector<GnssFix> SimulateGnss(const Motion& motion, const Rig& rig, const SiteDatum& datum,
                                  const SensorOptions& options, std::uint64_t seed) {
  std::vector<GnssFix> fixes;
  if (options.gnss == "none") return fixes;
  Random random(seed, 0x6e);
  const bool is_rtk = options.gnss == "rtk";
  const double sigma = options.gnss_sigma > 0 ? options.gnss_sigma : is_rtk ? 0.02 : 0.8;
  const Eigen::Vector3d sigmas = sigma * Eigen::Vector3d(1, 1, 1.8);
  // Standard receivers err slowly: most of the error is a Gauss-Markov process of a minute.
  const double slow_share = is_rtk ? 0 : 0.9, white_share = std::sqrt(1 - slow_share * slow_share);
  const double keep = std::exp(-1 / (60 * kGnssRate));
  Eigen::Vector3d slow = NormalVector(random);
  for (const Timestamp time : Ticks(motion, kGnssRate, 0.0631, seed)) {
    slow = keep * slow + std::sqrt(1 - keep * keep) * NormalVector(random);
    const Eigen::Vector3d error = sigmas.cwiseProduct(slow_share * slow + white_share * NormalVector(random));
    const Eigen::Vector3d antenna = motion.WorldFromBody(time - DriveEpoch(seed)) * *rig.vehicle->antenna_in_body;
    const Geodetic place = GeodeticFromSite(datum, antenna + error);
    fixes.push_back({time, place.latitude_deg, place.longitude_deg, place.altitude, sigmas});
  }
  return fixes;
}

std::vector<ScheduledFrame> ScheduleFrames(const Motion& motion, size_t num_cameras, const CameraClockOptions& options,
                                           double margin, std::uint64_t seed) {
  std::vector<ScheduledFrame> frames;
  for (size_t camera = 0; camera < num_cameras; ++camera) {
    Random random(seed, 0xca0 + camera);
    const double phase = margin + random.Uniform() / options.rate;
    for (double tick = phase; tick < motion.Duration() - margin - 3 * options.jitter; tick += 1 / options.rate) {
      const double jitter = options.jitter * std::clamp(random.Normal(), -3.0, 3.0);
      const bool is_lost = random.Chance(options.drop_probability);
      if (!is_lost) frames.push_back({DriveEpoch(seed) + std::max(margin, tick + jitter), camera});
    }
  }
  std::sort(frames.begin(), frames.end(), [](const ScheduledFrame& a, const ScheduledFrame& b) {
    return std::pair(a.time, a.camera) < std::pair(b.time, b.camera);
  });
  return frames;
}

}  // namespace parkade::simulator
