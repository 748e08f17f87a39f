#include "tests/simulator/speed_profile.h"

#include <algorithm>
#include <cmath>

namespace parkade::simulator {
namespace {

constexpr double kDistanceStep = 0.01;  // [m]

/// Highest speed [m/s] at each step of a stretch that begins and ends standing.
std::vector<double> SpeedLimits(const Route& route, const SpeedOptions& options, double from, double to) {
  const size_t size = std::max<size_t>(3, static_cast<size_t>((to - from) / kDistanceStep) + 1);
  std::vector<double> speeds(size);
  for (size_t i = 0; i < size; ++i) {
    const double curvature = std::abs(route.Curvature(from + kDistanceStep * static_cast<double>(i)));
    speeds[i] = std::min(options.max_speed, std::sqrt(options.max_lateral_acceleration / std::max(curvature, 1e-6)));
  }
  speeds.front() = speeds.back() = 0;
  for (size_t i = 1; i < size; ++i)
    speeds[i] =
        std::min(speeds[i], std::sqrt(speeds[i - 1] * speeds[i - 1] + 2 * options.max_acceleration * kDistanceStep));
  for (size_t i = size - 1; i-- > 0;)
    speeds[i] =
        std::min(speeds[i], std::sqrt(speeds[i + 1] * speeds[i + 1] + 2 * options.max_deceleration * kDistanceStep));
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

}  // namespace

SpeedProfile::SpeedProfile(const Route& route, const SpeedOptions& options) {
  const double stop = options.stop_at * route.Length();
  std::vector<double> times = {0, options.initial_stand}, distances = {0, 0};
  const auto drive = [&](double from, double to) {
    const std::vector<double> speeds = SpeedLimits(route, options, from, to);
    for (size_t i = 1; i < speeds.size(); ++i) {
      times.push_back(times.back() + 2 * kDistanceStep / (speeds[i - 1] + speeds[i]));
      distances.push_back(from + kDistanceStep * static_cast<double>(i));
    }
  };
  const auto stand = [&](double seconds) {
    times.push_back(times.back() + seconds);
    distances.push_back(distances.back());
  };
  drive(0, stop);
  stand(options.stop);
  drive(distances.back(), route.Length());
  stand(options.final_stand);

  for (size_t i = 0, next = 1; next < times.size(); ++i) {
    const double time = step_ * static_cast<double>(i);
    while (next < times.size() && times[next] < time) ++next;
    if (next == times.size()) break;
    const double fraction = (time - times[next - 1]) / std::max(1e-9, times[next] - times[next - 1]);
    distances_.push_back(distances[next - 1] + fraction * (distances[next] - distances[next - 1]));
  }
  // Pedals move smoothly: three running means bound the jerk and its rate.
  for (const double width : {0.3, 0.2, 0.2}) distances_ = Smoothed(distances_, static_cast<int>(width / step_));
}

double SpeedProfile::Distance(double time) const {
  const double place = std::clamp(time / step_, 0.0, static_cast<double>(distances_.size() - 1));
  const size_t index = std::min(static_cast<size_t>(place), distances_.size() - 2);
  const double fraction = place - static_cast<double>(index);
  return distances_[index] * (1 - fraction) + distances_[index + 1] * fraction;
}

double SpeedProfile::Speed(double time) const {
  const double reach = 0.02;
  return (Distance(time + reach) - Distance(time - reach)) / (2 * reach);
}

double SpeedProfile::Acceleration(double time) const {
  const double reach = 0.05;
  return (Distance(time + reach) - 2 * Distance(time) + Distance(time - reach)) / (reach * reach);
}

}  // namespace parkade::simulator
