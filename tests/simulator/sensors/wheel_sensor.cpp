#include "tests/simulator/sensors/wheel_sensor.h"

#include <algorithm>
#include <cmath>

#include "tests/simulator/common/drive_clock.h"
#include "tests/simulator/common/random.h"

namespace parkade::simulator {
namespace {

constexpr double kRate = 100;  // [Hz]
constexpr double kSlipPerAcceleration =
    0.002;  // [s^2/m] of rolling tires, as tires of passenger cars have
constexpr double kSlipperyAcceleration = 1;  // [m/s^2]

/// Along the body's x.
double ForwardAcceleration(const MotionState& state) {
  return (state.world_from_body.rotation.conjugate() * state.acceleration_in_world).x();
}

/// Ratio of slip at a time: it comes and goes within a tenth of a second.
double SlipAt(const std::vector<WheelSlip>& slips, double time) {
  double ratio = 0;
  for (const WheelSlip& slip : slips) {
    const double inside = std::min(time - slip.begin, slip.end - time);
    if (inside > 0) ratio += slip.ratio * std::min(1.0, inside / 0.1);
  }
  return ratio;
}

}  // namespace

std::vector<WheelSlip> PlanSlips(const Motion& motion, const SensorOptions& options,
                                 std::uint64_t seed) {
  constexpr double kStep = 0.1;  // [s]
  Random random(seed, 0x511);
  std::vector<WheelSlip> slips;
  for (double time = 0; time < motion.Duration(); time += kStep) {
    const double acceleration = ForwardAcceleration(motion.At(time));
    const bool starts = random.Chance(options.wheel_slips * kStep / 60);
    const double duration = random.Uniform(0.2, 0.6), ratio = random.Uniform(0.04, 0.12);
    if (!starts || std::abs(acceleration) < kSlipperyAcceleration) continue;
    const MotionState state = motion.At(time);
    const double speed = (state.world_from_body.rotation.conjugate() * state.velocity_in_world).x();
    slips.push_back({time, time + duration, std::copysign(ratio, acceleration * speed)});
  }
  return slips;
}

std::vector<WheelSample> SimulateWheels(const Motion& motion, const SensorOptions& options,
                                        std::uint64_t seed,
                                        const std::vector<WheelSlip>& more_slips) {
  std::vector<WheelSlip> slips = PlanSlips(motion, options, seed);
  slips.insert(slips.end(), more_slips.begin(), more_slips.end());
  Random random(seed, 0x3e);
  const double yaw_scale = 1 + 0.004 * options.wheel_noise * random.Normal();
  std::vector<WheelSample> samples;
  for (const Timestamp time : Ticks(motion.Duration(), kRate, 0.0047, seed)) {
    const double since_start = time - DriveEpoch(seed);
    const MotionState state = motion.At(since_start);
    const double speed = (state.world_from_body.rotation.conjugate() * state.velocity_in_world).x();
    const double tires = options.wheel_noise * kSlipPerAcceleration * ForwardAcceleration(state) *
                         std::copysign(1, speed);
    // Wheels that stand give no pulses: no speed, and no noise either.
    const double rolling = options.wheel_noise * std::min(1.0, std::abs(speed) / 0.2);
    WheelSample sample{
        time, speed * (1 + options.wheel_scale_error) * (1 + tires + SlipAt(slips, since_start)),
        state.angular_velocity_in_body.z() * yaw_scale};
    sample.forward_speed += rolling * (0.012 + 0.002 * std::abs(speed)) * random.Normal();
    sample.yaw_rate += rolling * 0.006 * random.Normal();
    if (std::abs(speed) < 1e-3) sample.forward_speed = sample.yaw_rate = 0;
    samples.push_back(sample);
  }
  return samples;
}

}  // namespace parkade::simulator
