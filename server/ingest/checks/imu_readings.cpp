#include "server/ingest/checks/imu_readings.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/math/statistics.h"

namespace parkade {
namespace {

constexpr std::size_t kNumFirstReadings = 4000;
constexpr std::size_t kMinReadings = 500;  // fewer tell nothing

// The names of the six readings.
constexpr const char* kNames[6] = {"rate about x",         "rate about y",
                                   "rate about z",         "acceleration along x",
                                   "acceleration along y", "acceleration along z"};

const char* UnitOf(std::size_t axis) { return axis < 3 ? "rad/s" : "m/s2"; }

/// The step between readings: their smallest difference, where they are many and few are distinct.
std::optional<double> StepOf(const std::vector<float>& readings) {
  const std::set<float> distinct(readings.begin(), readings.end());
  if (readings.size() < kMinReadings || distinct.size() < 2 || distinct.size() > 24)
    return std::nullopt;
  double step = INFINITY;
  for (auto it = std::next(distinct.begin()); it != distinct.end(); ++it)
    step = std::min(step, static_cast<double>(*it) - *std::prev(it));
  return step;
}

bool IsSame(const ImuSample& a, const ImuSample& b) {
  return a.angular_velocity == b.angular_velocity && a.linear_acceleration == b.linear_acceleration;
}

}  // namespace

bool ImuReadings::IsLong(const Run& run) {
  return run.span.Seconds() >= 0.5 && run.num_repeats >= 20;
}

void ImuReadings::Include(const ImuSample& sample) {
  ++num_samples_;
  if (last_ && first_steps_.size() < kNumFirstReadings)
    first_steps_.push_back(static_cast<float>(sample.time - last_->time));
  IncludeInRun(sample);
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i % 3);
    const double reading = i < 3 ? sample.angular_velocity[at] : sample.linear_acceleration[at];
    Axis& axis = axes_[i];
    if (num_samples_ == 1) axis.first = reading;
    axis.is_constant = axis.is_constant && reading == axis.first;
    if (std::abs(reading) > axis.largest) {
      axis.largest = std::abs(reading);
      axis.num_largest = 0;
    }
    if (std::abs(reading) == axis.largest) ++axis.num_largest;
    if (axis.first_readings.size() < kNumFirstReadings)
      axis.first_readings.push_back(static_cast<float>(reading));
  }
}

void ImuReadings::IncludeInRun(const ImuSample& sample) {
  if (last_ && IsSame(*last_, sample)) {
    ++num_repeats_;
    ++run_.num_repeats;
    run_.span.Include(sample.time);
    run_.rate = sample.angular_velocity.norm();
  } else {
    if (IsLong(run_)) long_runs_.push_back(run_);
    run_ = {};
  }
  last_ = sample;
}

std::vector<TimeSpan> ImuReadings::StuckSpans(const SpeedHistory& wheels) const {
  constexpr double kMaxRepeats = 0.02;  // share of samples, outside of long runs
  constexpr std::uint64_t kMinChanges = 100;
  constexpr double kMinSpeed = 0.3;  // [m/s]
  constexpr double kMinRate = 0.03;  // [rad/s], beyond the bias of a gyroscope at rest
  std::vector<Run> runs = long_runs_;
  if (IsLong(run_)) runs.push_back(run_);
  std::uint64_t num_lone = num_repeats_;
  for (const Run& run : runs) num_lone -= run.num_repeats;
  if (static_cast<double>(num_lone) > kMaxRepeats * static_cast<double>(num_samples_) ||
      num_samples_ - num_repeats_ < kMinChanges)
    return {};
  std::vector<TimeSpan> spans;
  std::size_t hint = 0;
  for (const Run& run : runs) {
    const auto speed = wheels.Near(run.span.begin + run.span.Seconds() / 2, hint);
    const bool moves = speed ? std::abs(speed->forward_speed) > kMinSpeed : run.rate > kMinRate;
    if (moves) spans.push_back(run.span);
  }
  return spans;
}

bool ImuReadings::AreAccelerationsVaried() const {
  const std::vector<float>& x = axes_[3].first_readings;
  return std::set<float>(x.begin(), x.end()).size() > 10;
}

bool ImuReadings::HasMoved(double way) const {
  constexpr double kMinWay = 5, kMinRate = 0.2;  // [m], [rad/s]
  return way > kMinWay || std::any_of(axes_.begin(), axes_.begin() + 3,
                                      [](const Axis& axis) { return axis.largest > kMinRate; });
}

std::optional<Finding> ImuReadings::CheckConstant(std::size_t axis) const {
  constexpr double kFineStep[2] = {0.005, 0.08};  // [rad/s], [m/s^2]: coarser ones hide motion
  const std::size_t first = axis / 3 * 3;
  if (!axes_[axis].is_constant || num_samples_ < kMinReadings) return std::nullopt;
  // Where nothing changes, or in coarse steps only, something else is wrong.
  for (std::size_t i = first; i < first + 3; ++i) {
    const std::optional<double> step = StepOf(axes_[i].first_readings);
    if (step && *step > kFineStep[first / 3]) return std::nullopt;
  }
  if (std::all_of(axes_.begin() + static_cast<std::ptrdiff_t>(first),
                  axes_.begin() + static_cast<std::ptrdiff_t>(first) + 3,
                  [](const Axis& other) { return other.is_constant; }))
    return std::nullopt;
  return Finding{"imu_axis_dead",
                 Severity::kUnusable,
                 "",
                 FormatText("reads the same %s all the time: %.4g %s", kNames[axis],
                            axes_[axis].first, UnitOf(axis)),
                 "record all three axes of both sensors; none may be filled in",
                 {{"reading", axes_[axis].first}}};
}

bool ImuReadings::IsSaturated(const Axis& axis, bool is_rate) const {
  const double share = static_cast<double>(axis.num_largest) / static_cast<double>(num_samples_);
  if (axis.num_largest < 10 || share < 0.002 || axis.is_constant) return false;
  if (share < 0.5 && axis.largest > (is_rate ? 0.3 : 11)) return true;
  // The largest of readings with many values hardly comes again by chance.
  const std::set<float> distinct(axis.first_readings.begin(), axis.first_readings.end());
  return share > 0.01 && distinct.size() > 100 && axis.largest > (is_rate ? 0.05 : 2);
}

std::optional<Finding> ImuReadings::CheckSteps() const {
  constexpr double kSlow = 8;         // [Hz]
  constexpr double kFew = 16;         // [Hz]
  constexpr double kInPackets = 0.2;  // of the mean step, which most do not reach
  if (first_steps_.size() < 20) return std::nullopt;
  double sum = 0;
  for (const float step : first_steps_) sum += step;
  const double mean = sum / static_cast<double>(first_steps_.size());
  const double median = Median(std::vector<double>(first_steps_.begin(), first_steps_.end()));
  if (mean > 1 / kSlow)
    return WarningOf(
        "imu_slow",
        FormatText("is read %.1f times a second only: the path between is a guess", 1 / mean),
        "record 100 samples a second or more", {{"rate_hz", 1 / mean}});
  if (mean > 1 / kFew)
    return Finding{"imu_slow",
                   Severity::kNote,
                   "",
                   FormatText("is read %.1f times a second: without wheels, that is few", 1 / mean),
                   "record 100 samples a second or more",
                   {{"rate_hz", 1 / mean}}};
  if (median < kInPackets * mean)
    return WarningOf("imu_in_packets",
                     FormatText("comes in packets whose samples have nearly one stamp: most follow "
                                "after %.2g s, where %.2g s lie between in the mean",
                                median, mean),
                     "stamp samples when they are taken, not when they arrive",
                     {{"median_step_s", median}, {"mean_step_s", mean}});
  return std::nullopt;
}

std::vector<Finding> ImuReadings::Findings(double way) const {
  std::vector<Finding> findings;
  if (std::optional<Finding> found = CheckSteps()) findings.push_back(std::move(*found));
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const Axis& axis = axes_[i];
    std::optional<Finding> constant = HasMoved(way) ? CheckConstant(i) : std::nullopt;
    if (constant) {
      findings.push_back(std::move(*constant));
      continue;
    }
    const std::optional<double> step = StepOf(axis.first_readings);
    if (step && *step > (i < 3 ? 0.01 : 0.15)) {
      findings.push_back(
          WarningOf("imu_resolution",
                    FormatText("has a %s in steps of %.3g %s only", kNames[i], *step, UnitOf(i)),
                    "set a smaller range of the sensor", {{"step", *step}}));
      continue;
    }
    if (IsSaturated(axis, i < 3))
      findings.push_back(WarningOf(
          "imu_saturated",
          FormatText("reads exactly %.4g %s as %s %llu times: it is at the end of its range",
                     axis.largest, UnitOf(i), kNames[i],
                     static_cast<unsigned long long>(axis.num_largest)),
          "set a larger range of the sensor", {{"largest", axis.largest}}));
  }
  return findings;
}

}  // namespace parkade
