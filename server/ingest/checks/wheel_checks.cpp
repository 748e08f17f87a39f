#include "server/ingest/checks/wheel_checks.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "core/math/statistics.h"

namespace parkade {
namespace {

constexpr double kReach = 1;  // [s] of delay that is looked for, early or late

/// Yaw rates of the body [rad/s] as a gyroscope reads them, in steps of time.
class YawRates {
 public:
  static constexpr double kStep = 0.01;  // [s]

  YawRates(const Rig& rig, const GyroscopeHistory& gyroscope, const TimeSpan& span)
      : begin_(span.begin) {
    const Eigen::RowVector3d yaw_of = rig.body_from_imu.rotation.toRotationMatrix().row(2);
    const auto count = static_cast<std::size_t>(span.Seconds() / kStep) + 1;
    rates_.reserve(count);
    for (std::size_t i = 0; i < count; ++i)
      rates_.push_back(yaw_of * gyroscope.RateAt(begin_ + kStep * static_cast<double>(i)));
  }

  /// Nothing outside of the span.
  std::optional<double> At(Timestamp time) const {
    const double index = std::round((time - begin_) / kStep);
    if (index < 0 || index >= static_cast<double>(rates_.size())) return std::nullopt;
    return rates_[static_cast<std::size_t>(index)];
  }

 private:
  Timestamp begin_;
  std::vector<double> rates_;
};

/// Moments of two series.
struct Moments {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;

  void Include(double a, double b) {
    ++n;
    x += a, y += b, xx += a * a, xy += a * b, yy += b * b;
  }
  double Slope() const { return (xy / n - x * y / n / n) / Variance(); }
  double Variance() const { return xx / n - x * x / n / n; }
  double Correlation() const {
    const double covariance = xy / n - x * y / n / n;
    return covariance / std::sqrt(std::max(Variance() * (yy / n - y * y / n / n), 1e-18));
  }
};

Moments Compare(const YawRates& gyroscope, const SpeedHistory& wheels, double delay) {
  constexpr std::size_t kMostSamples = 20'000;
  const std::vector<WheelSample>& samples = wheels.samples();
  Moments moments;
  for (std::size_t i = 0; i < samples.size(); i += 1 + samples.size() / kMostSamples)
    if (const std::optional<double> rate = gyroscope.At(samples[i].time + -delay))
      moments.Include(*rate, samples[i].yaw_rate);
  return moments;
}

/// [s] for which wheels repeat one speed that is not 0 to the last bit, though no two samples in a
/// row are the same otherwise; 0 where they do not.
double SecondsStuck(const SpeedHistory& wheels) {
  constexpr double kShortest = 2;       // [s]
  constexpr double kMaxRepeats = 0.02;  // share of the other samples
  constexpr std::size_t kMinSamples = 100;
  const std::vector<WheelSample>& samples = wheels.samples();
  double stuck = 0;
  std::size_t num_repeats = 0, num_stuck = 0;
  for (std::size_t begin = 0, end = 1; begin < samples.size(); begin = end++) {
    while (end < samples.size() && samples[end].forward_speed == samples[begin].forward_speed &&
           samples[end].yaw_rate == samples[begin].yaw_rate)
      ++end;
    const double seconds = samples[end - 1].time - samples[begin].time;
    const bool is_still = samples[begin].forward_speed == 0;
    if (is_still || seconds >= kShortest) {
      num_stuck += end - begin;
      if (!is_still) stuck += seconds;
    } else {
      num_repeats += end - begin - 1;
    }
  }
  const std::size_t num_others = samples.size() - num_stuck;
  const bool never_repeats =
      num_others >= kMinSamples &&
      static_cast<double>(num_repeats) <= kMaxRepeats * static_cast<double>(num_others);
  return never_repeats ? stuck : 0;
}

/// [m/s] below which wheels say 0, as encoders that count too few pulses do; 0 where they do not.
/// All such wheels leap between 0 and that speed, however slowly the car starts and stops.
double BlindSpeed(const SpeedHistory& wheels) {
  constexpr double kSmallest = 0.2;      // [m/s]
  constexpr double kMaxSpread = 0.3;     // of leaps, as a share of the least speed
  constexpr double kMaxStep = 0.15;      // [s] between the samples of a leap
  constexpr double kHardest = 5;         // [m/s^2] that a car starts or stops with
  constexpr double kMaxStepShare = 0.5;  // of the least speed, from one sample to the next
  constexpr double kMinStanding = 0.3;   // [s] of 0 before or behind it
  const std::vector<WheelSample>& samples = wheels.samples();
  double least = INFINITY;
  for (const WheelSample& sample : samples)
    if (sample.forward_speed != 0) least = std::min(least, std::abs(sample.forward_speed));
  if (!std::isfinite(least) || least < kSmallest) return 0;
  std::vector<double> leaps, steps;
  for (std::size_t i = 1; i < samples.size(); ++i)
    if (samples[i - 1].forward_speed != 0 && samples[i].forward_speed != 0)
      steps.push_back(std::abs(samples[i].forward_speed - samples[i - 1].forward_speed));
  // Speeds in another unit leap by more than their least one.
  if (steps.empty() || Median(steps) > kMaxStepShare * least) return 0;
  for (std::size_t begin = 0, end = 1; begin < samples.size(); begin = end++) {
    if (samples[begin].forward_speed != 0) continue;
    while (end < samples.size() && samples[end].forward_speed == 0) ++end;
    if (samples[end - 1].time - samples[begin].time < kMinStanding) continue;
    const auto include = [&](const WheelSample& still, const WheelSample& moving) {
      const double step = std::abs(moving.time - still.time), leap = std::abs(moving.forward_speed);
      if (step < kMaxStep && leap > kHardest * step) leaps.push_back(leap);
    };
    if (begin > 0) include(samples[begin], samples[begin - 1]);
    if (end < samples.size()) include(samples[end - 1], samples[end]);
  }
  return !leaps.empty() && Median(leaps) < (1 + kMaxSpread) * least ? least : 0;
}

}  // namespace

std::optional<Finding> CheckSpeeds(const SpeedHistory& wheels, const std::string& topic) {
  constexpr double kCoarse = 0.25;  // [m/s]
  constexpr std::size_t kMinSamples = 100;
  if (topic.empty() || wheels.empty()) return std::nullopt;
  if (wheels.IsAlwaysZero())
    return Finding{kWheelsAreZero,
                   Severity::kWarning,
                   topic,
                   "the wheels " + topic + " say 0 m/s from beginning to end and are left out",
                   "check that the encoders are connected, and that the speed is in twist.linear.x",
                   {}};
  std::set<double> distinct;
  for (const WheelSample& sample : wheels.samples()) distinct.insert(sample.forward_speed);
  if (wheels.samples().size() < kMinSamples || distinct.size() < 3) return std::nullopt;
  double step = INFINITY;
  for (auto it = std::next(distinct.begin()); it != distinct.end(); ++it)
    step = std::min(step, *it - *std::prev(it));
  if (const double blind = BlindSpeed(wheels); blind > 0 && step < kCoarse)
    return Finding{kWheelsAreBlind,
                   Severity::kWarning,
                   topic,
                   "the wheels " + topic +
                       FormatText(" say 0 m/s whenever the car is slower than %.2g m/s, and are "
                                  "left out",
                                  blind),
                   "record encoders that count at any speed, or no speed where they count none",
                   {{"least_speed_m_s", blind}}};
  if (step < kCoarse) return std::nullopt;
  return Finding{kWheelsAreCoarse,
                 Severity::kWarning,
                 topic,
                 "the wheels " + topic +
                     FormatText(" have speeds in steps of %.2g m/s and are left out", step),
                 "record what the encoders count, not a speed for the dashboard",
                 {{"step_m_s", step}}};
}

std::optional<Finding> CheckSticking(const SpeedHistory& wheels, int num_moving,
                                     const std::string& topic) {
  constexpr int kMinMoments = 3;
  if (topic.empty()) return std::nullopt;
  const double seconds = SecondsStuck(wheels);
  std::string what;
  if (num_moving >= kMinMoments)
    what = FormatText("say 0 m/s in %d moments in which cameras see the car move", num_moving);
  else if (seconds > 0)
    what = "repeat one speed for " + DurationText(seconds);
  else
    return std::nullopt;
  return Finding{kWheelsStick,
                 Severity::kWarning,
                 topic,
                 "the wheels " + topic + " " + what + " and are left out",
                 "check their driver and what connects them",
                 {{"seconds_stuck", seconds}, {"moving_moments", static_cast<double>(num_moving)}}};
}

std::optional<WheelDelay> FitWheelDelay(const Rig& rig, const GyroscopeHistory& gyroscope,
                                        const SpeedHistory& wheels) {
  constexpr double kMinDeviation = 0.05;  // [rad/s] of yaw rates over the drive
  constexpr double kMinCorrelation = 0.95;
  constexpr double kMinSamples = 200;
  constexpr double kLongest = 6 * 3600;  // [s]; over more, clocks leapt
  if (!rig.vehicle || wheels.empty()) return std::nullopt;
  const TimeSpan span{wheels.samples().front().time, wheels.samples().back().time};
  if (span.Seconds() > kLongest) return std::nullopt;
  const YawRates rates(rig, gyroscope, span);
  const int reach = static_cast<int>(kReach / YawRates::kStep);
  std::vector<double> correlations;
  correlations.reserve(static_cast<std::size_t>(2 * reach + 1));
  int best = -reach;
  for (int i = -reach; i <= reach; ++i) {
    correlations.push_back(Compare(rates, wheels, YawRates::kStep * i).Correlation());
    if (correlations.back() > correlations[static_cast<std::size_t>(best + reach)]) best = i;
  }
  const Moments moments = Compare(rates, wheels, YawRates::kStep * best);
  const double peak = correlations[static_cast<std::size_t>(best + reach)];
  if (std::abs(best) == reach || moments.n < kMinSamples || peak < kMinCorrelation ||
      moments.Variance() < kMinDeviation * kMinDeviation)
    return std::nullopt;
  // The peak is a parabola: where what is not explained doubles, the delay is off by one sigma of a
  // single sample. Noise of neighbors is alike: ten count as one.
  const double before = correlations[static_cast<std::size_t>(best + reach - 1)],
               behind = correlations[static_cast<std::size_t>(best + reach + 1)];
  const double bend = std::max(2 * peak - before - behind, 1e-12);
  const double shift = 0.5 * (behind - before) / bend;
  return WheelDelay{YawRates::kStep * (best + shift),
                    YawRates::kStep * std::sqrt((1 - peak * peak) / bend / (moments.n / 10)),
                    moments.Slope()};
}

std::optional<Finding> CheckWheelDelay(const WheelDelay& against_imu, double imu_delay,
                                       const std::string& topic) {
  constexpr double kMinDelay = 0.03, kSigmas = 6;  // [s]
  const double delay = against_imu.seconds + imu_delay;
  if (std::abs(delay) < std::max(kMinDelay, kSigmas * against_imu.sigma)) return std::nullopt;
  return Finding{kWheelsLate,
                 Severity::kWarning,
                 topic,
                 "the wheels " + topic +
                     FormatText(" are stamped %.0f ms too %s, by their turns, and are "
                                "used so much %s",
                                1000 * std::abs(delay), delay > 0 ? "late" : "early",
                                delay > 0 ? "earlier" : "later"),
                 "stamp them when they are measured",
                 {{kDelay, delay}, {"sigma", against_imu.sigma}}};
}

}  // namespace parkade
