#include "slam/odometry/wheel_agreement.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/math/statistics.h"

namespace parkade {
namespace {

constexpr double kMoving = 0.5;    // [m/s]
constexpr int kMinMoving = 20;     // samples
constexpr double kMaxScale = 1.2;  // and one over it
constexpr double kMaxError = 0.15;
constexpr double kMaxLasting = 0.05, kMaxLastingShare = 0.02;  // [m/s], of the speed
constexpr double kWindow = 0.3;                                // [s] over which noise is averaged
constexpr double kUsual = 0.8;                                 // of the windows are no worse
constexpr double kSureCorrelation = 0.97;
constexpr int kMaxDelaySteps = 30;
constexpr double kMinDelay = 0.08;   // [s] less costs little
constexpr double kDelayStep = 0.02;  // [s]

/// [m/s] of the body along its x axis at a time, by the two states around it.
std::optional<double> ForwardSpeed(const std::vector<TrajectoryState>& states, Timestamp time,
                                   size_t& hint) {
  while (hint + 1 < states.size() && states[hint + 1].time <= time) ++hint;
  if (hint + 1 >= states.size() || time < states[hint].time) return std::nullopt;
  const TrajectoryState &before = states[hint], &after = states[hint + 1];
  const double step = after.time - before.time;
  if (step > 0.3) return std::nullopt;
  const double share = (time - before.time) / step;
  const auto forward = [](const TrajectoryState& state) {
    return (state.world_from_body.rotation.conjugate() * state.velocity_in_world).x();
  };
  return (1 - share) * forward(before) + share * forward(after);
}

double CorrelationOf(const std::vector<double>& x, const std::vector<double>& y) {
  double xx = 0, xy = 0, yy = 0;
  for (size_t i = 0; i < x.size(); ++i) {
    xx += x[i] * x[i];
    xy += x[i] * y[i];
    yy += y[i] * y[i];
  }
  return xx > 0 && yy > 0 ? xy / std::sqrt(xx * yy) : 0;
}

bool IsNear(double value, double target) { return std::abs(value / target - 1) < 0.12; }

std::string Number(double value, int digits = 4) {
  char text[40];
  std::snprintf(text, sizeof(text), "%.*g", digits, value);
  return text;
}

/// [m/s] by which most windows of time are off at most, whatever the noise and a few slips. Such
/// errors of sound drives are 0.01 to 0.02, those of wheels that are another axle's, one wheel's or
/// another scale's from some moment on 0.1 and more.
double LastingError(const std::vector<Timestamp>& times, const std::vector<double>& differences) {
  std::vector<double> means;
  for (size_t begin = 0, end = 0; begin < times.size(); begin = end) {
    double sum = 0;
    while (end < times.size() && times[end] - times[begin] < kWindow) sum += differences[end++];
    means.push_back(std::abs(sum) / static_cast<double>(end - begin));
  }
  return Quantile(means, kUsual);
}

/// With the wheels' stamps taken to be late by so much.
WheelAgreement CompareAt(double delay, const Trajectory& odom_from_body,
                         const std::vector<WheelSample>& wheels) {
  std::vector<double> reported, actual, ratios;
  std::vector<Timestamp> times;
  size_t hint = 0;
  for (const WheelSample& sample : wheels) {
    const std::optional<double> speed =
        ForwardSpeed(odom_from_body.states(), sample.time - delay, hint);
    if (!speed || std::max(std::abs(*speed), std::abs(sample.forward_speed)) < kMoving) continue;
    times.push_back(sample.time);
    reported.push_back(sample.forward_speed);
    actual.push_back(*speed);
    if (sample.forward_speed != 0) ratios.push_back(*speed / sample.forward_speed);
  }
  WheelAgreement agreement;
  agreement.num_moving = static_cast<int>(reported.size());
  if (reported.empty()) return agreement;
  agreement.delay = delay;
  agreement.scale = ratios.empty() ? 0 : Median(ratios);
  agreement.correlation = CorrelationOf(reported, actual);
  std::vector<double> differences, errors, wheel_speeds, speeds;
  for (size_t i = 0; i < reported.size(); ++i) {
    differences.push_back(agreement.scale * reported[i] - actual[i]);
    errors.push_back(std::abs(differences.back()));
    wheel_speeds.push_back(std::abs(reported[i]));
    speeds.push_back(std::abs(actual[i]));
  }
  agreement.wheel_speed = Median(wheel_speeds);
  agreement.speed = Median(speeds);
  agreement.error = agreement.speed > 0 ? Median(errors) / agreement.speed : 1;
  agreement.lasting_error = LastingError(times, differences);
  return agreement;
}

}  // namespace

bool WheelAgreement::Fits() const {
  return num_moving < kMinMoving ||
         (scale < kMaxScale && scale > 1 / kMaxScale && error < kMaxError && delay == 0 &&
          lasting_error < std::max(kMaxLasting, kMaxLastingShare * speed));
}

std::string WheelAgreement::Doubt() const {
  if (wheel_speed < 0.05 * speed)
    return "say " + Number(wheel_speed) + " m/s while the car drives " + Number(speed) +
           " m/s: check the encoders, and that the speed is in twist.linear.x of the body frame";
  if (delay != 0 && scale < kMaxScale && scale > 1 / kMaxScale)
    return "are stamped " + Number(std::abs(delay)) + " s too " + (delay > 0 ? "late" : "early") +
           ", as it seems: stamp them when they are measured";
  const std::string measured = "the car's speed is " + Number(scale) + " times theirs";
  if (std::abs(correlation) < kSureCorrelation || (scale < kMaxScale && scale > 1 / kMaxScale))
    return "contradict the motion that cameras and IMU show, by " + Number(lasting_error, 2) +
           " m/s or more at times, where the car drives " + Number(speed, 2) +
           ": check that twist.linear.x is the speed of the middle of the rear axle along the car, "
           "in m/s and stamped when it was measured, and that the IMU sits as the rig says";
  const auto remedy = [](double value) {
    return ": set wheel_scale: " + Number(value) + " in vehicle.yaml";
  };
  struct Unit {
    double scale;
    const char* looks_like;
  };
  static constexpr Unit kUnits[] = {{-1, "have the sign reversed"},
                                    {1 / 3.6, "are in km/h"},
                                    {0.44704, "are in miles per hour"},
                                    {1e-2, "are in cm/s"},
                                    {1e-3, "are in mm/s"}};
  for (const Unit& unit : kUnits)
    if (IsNear(scale, unit.scale))
      return std::string(unit.looks_like) + ", as it seems: " + measured + remedy(unit.scale);
  return "have another scale: " + measured + remedy(scale);
}

WheelAgreement CompareWheels(const Trajectory& odom_from_body,
                             const std::vector<WheelSample>& wheels) {
  WheelAgreement agreement = CompareAt(0, odom_from_body, wheels);
  if (agreement.num_moving < kMinMoving) return agreement;
  // A car that drives evenly shows no delay: only what makes a difference is one.
  WheelAgreement best = agreement;
  for (int step = -kMaxDelaySteps; step <= kMaxDelaySteps; ++step) {
    const WheelAgreement delayed = CompareAt(step * kDelayStep, odom_from_body, wheels);
    if (delayed.error < best.error) best = delayed;
  }
  if (std::abs(best.delay) > kMinDelay && agreement.error > 2 * best.error + 0.01) return best;
  return agreement;
}

}  // namespace parkade
