#include "tests/simulator/motion/speed_profile.h"

#include <algorithm>
#include <cmath>

namespace parkade::simulator {
namespace {

constexpr double kDistanceStep = 0.01;  // [m]

/// Whether the way leads from deck to deck there: of routes in the open the hint of the height does
/// not change.
bool IsOnRamp(const Route& route, double distance) {
  constexpr double kReach = 1, kLeastSlope = 0.03;  // [m]
  const double rise = route.HeightHint(distance + kReach) - route.HeightHint(distance - kReach);
  return std::abs(rise) > 2 * kReach * kLeastSlope;
}

/// Highest speed [m/s] at each step of a stretch that begins and ends standing.
std::vector<double> SpeedLimits(const Leg& leg, const SpeedOptions& options, double from,
                                double to) {
  const size_t size = std::max<size_t>(3, static_cast<size_t>((to - from) / kDistanceStep) + 1);
  const double max_speed = leg.is_reverse ? options.max_reverse_speed : options.max_speed;
  std::vector<double> speeds(size);
  for (size_t i = 0; i < size; ++i) {
    const double distance = from + kDistanceStep * static_cast<double>(i);
    const double curvature = std::abs(leg.route.Curvature(distance));
    const double most =
        IsOnRamp(leg.route, distance) ? std::min(max_speed, options.max_ramp_speed) : max_speed;
    speeds[i] =
        std::min(most, std::sqrt(options.max_lateral_acceleration / std::max(curvature, 1e-6)));
  }
  speeds.front() = speeds.back() = 0;
  for (size_t i = 1; i < size; ++i)
    speeds[i] = std::min(speeds[i], std::sqrt(speeds[i - 1] * speeds[i - 1] +
                                              2 * options.max_acceleration * kDistanceStep));
  for (size_t i = size - 1; i-- > 0;)
    speeds[i] = std::min(speeds[i], std::sqrt(speeds[i + 1] * speeds[i + 1] +
                                              2 * options.max_deceleration * kDistanceStep));
  return speeds;
}

/// Running mean over 2 * half + 1 values; the ends are repeated.
std::vector<double> Smoothed(const std::vector<double>& values, int half) {
  const int size = static_cast<int>(values.size());
  const auto at = [&](int i) { return values[static_cast<size_t>(std::clamp(i, 0, size - 1))]; };
  std::vector<double> result(values.size());
  for (int i = 0; i < size; ++i) {
    double sum = 0;
    for (int k = -half; k <= half; ++k) sum += at(i + k);
    result[static_cast<size_t>(i)] = sum / (2 * half + 1);
  }
  return result;
}

/// Way over time at the corners of a polyline.
struct Course {
  std::vector<double> times = {0}, ways = {0};

  void Stand(double seconds) {
    times.push_back(times.back() + seconds);
    ways.push_back(ways.back());
  }

  void Drive(const Leg& leg, const SpeedOptions& options, double from, double to) {
    const std::vector<double> speeds = SpeedLimits(leg, options, from, to);
    const double step = (to - from) / static_cast<double>(speeds.size() - 1),
                 sign = leg.is_reverse ? -1 : 1;
    const double begin = ways.back();
    for (size_t i = 1; i < speeds.size(); ++i) {
      times.push_back(times.back() + 2 * step / (speeds[i - 1] + speeds[i]));
      ways.push_back(begin + sign * step * static_cast<double>(i));
    }
  }

  std::vector<double> Sampled(double step) const {
    std::vector<double> samples;
    for (size_t i = 0, next = 1;; ++i) {
      const double time = step * static_cast<double>(i);
      while (next < times.size() && times[next] < time) ++next;
      if (next == times.size()) return samples;
      const double fraction =
          (time - times[next - 1]) / std::max(1e-9, times[next] - times[next - 1]);
      samples.push_back(ways[next - 1] + fraction * (ways[next] - ways[next - 1]));
    }
  }
};

}  // namespace

SpeedProfile::SpeedProfile(const DrivePath& path, const SpeedOptions& options) {
  Course course;
  course.Stand(options.initial_stand);
  for (size_t index = 0; index < path.legs().size(); ++index) {
    const Leg& leg = path.legs()[index];
    const double length = leg.route.Length();
    if (index > 0 && index <= options.leg_stands.size())
      course.Stand(options.leg_stands[index - 1]);
    legs_.push_back({course.times.back(), course.ways.back(), length, leg.is_reverse});
    double from = 0;
    for (size_t i = 0; index == 0 && i < options.stops.size(); ++i) {
      const double stop =
          length * (static_cast<double>(i) + 0.9) / static_cast<double>(options.stops.size() + 1);
      course.Drive(leg, options, from, stop);
      course.Stand(options.stops[i]);
      from = stop;
    }
    course.Drive(leg, options, from, length);
  }
  course.Stand(options.final_stand);
  legs_.front().begin_time = 0;
  ways_ = course.Sampled(step_);
  // Pedals move smoothly: three running means bound the jerk and its rate.
  for (const double width : {0.3, 0.2, 0.2})
    ways_ = Smoothed(ways_, static_cast<int>(width / step_));
  if (options.rolling_speed > 0) start_ = FirstTimeAt(options.rolling_speed);
}

double SpeedProfile::FirstTimeAt(double speed) const {
  double top = 0;
  for (double time = 0; time < Duration(); time += step_) top = std::max(top, Speed(time));
  double time = 0;
  while (time < Duration() && Speed(time) < std::min(speed, 0.9 * top)) time += step_;
  return time;
}

double SpeedProfile::Way(double time) const {
  const double place =
      std::clamp((start_ + time) / step_, 0.0, static_cast<double>(ways_.size() - 1));
  const size_t index = std::min(static_cast<size_t>(place), ways_.size() - 2);
  const double fraction = place - static_cast<double>(index);
  return ways_[index] * (1 - fraction) + ways_[index + 1] * fraction;
}

double SpeedProfile::Speed(double time) const {
  const double reach = 0.02;
  return (Way(time + reach) - Way(time - reach)) / (2 * reach);
}

double SpeedProfile::Acceleration(double time) const {
  const double reach = 0.05;
  return (Way(time + reach) - 2 * Way(time) + Way(time - reach)) / (reach * reach);
}

size_t SpeedProfile::LegAt(double time) const {
  size_t leg = 0;
  while (leg + 1 < legs_.size() && legs_[leg + 1].begin_time <= start_ + time) ++leg;
  return leg;
}

double SpeedProfile::DistanceInLeg(double time) const {
  const LegSpan& leg = legs_[LegAt(time)];
  return std::clamp((leg.is_reverse ? -1 : 1) * (Way(time) - leg.begin_way), 0.0, leg.length);
}

double SpeedProfile::DistanceAlong(double time) const {
  double distance = DistanceInLeg(time);
  for (size_t leg = 0; leg < LegAt(time); ++leg) distance += legs_[leg].length;
  return distance;
}

double SpeedProfile::Traveled(double time) const { return DistanceAlong(time) - DistanceAlong(0); }

}  // namespace parkade::simulator
