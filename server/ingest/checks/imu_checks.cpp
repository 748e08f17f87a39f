#include "server/ingest/checks/imu_checks.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/math/statistics.h"

namespace parkade {
namespace {

constexpr double kGravity = 9.80665;  // [m/s^2]
constexpr double kBin = 0.1;          // [s]
constexpr std::size_t kMinBins = 10;  // fewer tell nothing
constexpr double kDegree = std::numbers::pi / 180;
constexpr double kUsualGain = 0.04, kUsualGainInFlight = 0.15;  // shares that accelerations are off

bool IsWithin(double value, double target, double share) {
  return std::abs(value / target - 1) <= share;
}

/// Which way of the car a direction of its body points.
std::string SideOf(const Eigen::Vector3d& direction) {
  Eigen::Index axis = 0;
  direction.cwiseAbs().maxCoeff(&axis);
  static constexpr const char* kSides[3][2] = {
      {"back", "front"}, {"right", "left"}, {"floor", "roof"}};
  return kSides[axis][direction[axis] > 0 ? 1 : 0];
}

bool HasUnusable(const std::vector<Finding>& findings) {
  return std::any_of(findings.begin(), findings.end(), [](const Finding& finding) {
    return finding.severity == Severity::kUnusable;
  });
}

}  // namespace

void ImuChecks::Include(const ImuSample& sample) {
  ++num_samples_;
  readings_.Include(sample);
  const bool has_rate = !sample.angular_velocity.isZero(0);
  num_without_rate_ += has_rate ? 0 : 1;
  num_without_acceleration_ += sample.linear_acceleration.isZero(0) ? 1 : 0;
  if (had_rate_[0] && !had_rate_[1] && has_rate) ++num_lone_without_rate_;
  had_rate_ = {had_rate_[1], has_rate};

  if (bins_.empty() || sample.time - bins_.back().begin >= kBin) bins_.push_back({sample.time});
  Bin& bin = bins_.back();
  ++bin.count;
  bin.rate += sample.angular_velocity.cast<float>();
  bin.acceleration += sample.linear_acceleration.cast<float>();
}

std::vector<Finding> ImuChecks::Findings(const std::string& topic,
                                         const SpeedHistory& wheels) const {
  std::vector<Finding> findings;
  if (bins_.size() < kMinBins) return findings;
  const auto add = [&findings](const std::optional<Finding>& found) {
    if (found) findings.push_back(*found);
    return found && found->severity == Severity::kUnusable;
  };
  // What one of these finds explains what the next would find.
  const std::vector<Finding> of_readings = readings_.Findings(wheels.Length());
  const bool is_wrong = add(CheckHalves(wheels)) || HasUnusable(of_readings) ||
                        add(CheckChange()) || add(CheckAccelerations()) ||
                        add(CheckGravity(wheels));
  if (!add(CheckRates(wheels)) && !is_wrong) add(CheckHeading(wheels));
  findings.insert(findings.end(), of_readings.begin(), of_readings.end());
  add(CheckStuck(wheels));
  for (Finding& finding : findings) {
    finding.topic = topic;
    finding.sentence = "the IMU " + topic + " " + finding.sentence;
  }
  return findings;
}

std::optional<Finding> ImuChecks::CheckHalves(const SpeedHistory& wheels) const {
  const auto all = static_cast<double>(num_samples_);
  const double without_acceleration = static_cast<double>(num_without_acceleration_) / all,
               without_rate = static_cast<double>(num_without_rate_) / all,
               lone = static_cast<double>(num_lone_without_rate_) / all;
  if (num_without_acceleration_ == num_samples_)
    return UnusableOf(
        "imu_without_accelerations",
        "holds no accelerations: all of them are zero, as in a topic of a gyroscope alone",
        "record accelerations and rates in one sensor_msgs/Imu",
        {{"share_without_acceleration", 1}});
  if (num_without_rate_ == num_samples_ && readings_.AreAccelerationsVaried())
    return UnusableOf(
        kImuWithoutRates,
        "holds no rates: all of them are zero, as in a topic of an accelerometer alone",
        "record accelerations and rates in one sensor_msgs/Imu",
        {{"share_without_rate", 1}, {kWay, wheels.Length()}});
  if (without_acceleration > 0.02 || lone > 0.2)
    return UnusableOf(
        "imu_in_halves",
        FormatText("holds halves: %.0f %% of its messages have no acceleration, %.0f %% no rates",
                   100 * without_acceleration, 100 * without_rate),
        "join both sensors' messages into one sensor_msgs/Imu of both",
        {{"share_without_acceleration", without_acceleration},
         {"share_without_rate", without_rate}});
  return std::nullopt;
}

std::optional<Finding> ImuChecks::CheckChange() const {
  constexpr double kLargestRatio = 1.25;
  constexpr std::size_t kMinPart = 20, kMaxSplits = 40;  // bins
  if (!rig_.vehicle || bins_.size() < 2 * kMinPart) return std::nullopt;
  std::vector<double> norms;
  for (const Bin& bin : bins_) norms.push_back((bin.acceleration / bin.count).norm());
  const auto median_of = [&](std::size_t begin, std::size_t end) {
    return Median(std::vector<double>(norms.begin() + static_cast<std::ptrdiff_t>(begin),
                                      norms.begin() + static_cast<std::ptrdiff_t>(end)));
  };
  // Where two medians fit best, if they are far apart.
  double least = INFINITY, before = 0, behind = 0;
  Timestamp change = bins_.front().begin;
  const std::size_t step = 1 + bins_.size() / kMaxSplits;
  for (std::size_t split = kMinPart; split + kMinPart <= bins_.size(); split += step) {
    const double first = median_of(0, split), second = median_of(split, bins_.size());
    double off = 0;
    for (std::size_t i = 0; i < norms.size(); ++i)
      off += std::abs(norms[i] - (i < split ? first : second));
    if (off >= least) continue;
    least = off, before = first, behind = second;
    change = bins_[split].begin;
  }
  if (std::max(before, behind) <= kLargestRatio * std::min(before, behind)) return std::nullopt;
  // Where neither is right, other checks know what it looks like.
  if (!IsWithin(before, kGravity, 0.15) && !IsWithin(behind, kGravity, 0.15)) return std::nullopt;
  const double seconds = change - bins_.front().begin;
  return UnusableOf("imu_changes",
                    FormatText("reads %.3g m/s2 for %.0f s and %.3g m/s2 from there on, where "
                               "gravity alone makes 9.8",
                               before, seconds, behind),
                    "find what its driver changed there, and map both parts on their own",
                    {{"before_m_s2", before}, {"behind_m_s2", behind}, {"at_s", seconds}});
}

std::optional<Finding> ImuChecks::CheckAccelerations() const {
  std::vector<double> norms;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Bin& bin : bins_) {
    const Eigen::Vector3d acceleration = bin.acceleration.cast<double>() / bin.count;
    norms.push_back(acceleration.norm());
    mean += acceleration / static_cast<double>(bins_.size());
  }
  const double median = Median(norms);
  const std::map<std::string, double> evidence = {{"median_acceleration_m_s2", median},
                                                  {"mean_acceleration_m_s2", mean.norm()}};
  const std::string measured = FormatText("%.3g m/s2 where gravity alone makes 9.8", median);
  const auto in_unit = [&](const char* name, const char* unit, double scale) {
    return UnusableOf(
        name, std::string("reads accelerations in ") + unit + ", as it seems: " + measured,
        FormatText("set accelerometer_scale: %.6g in imu0.yaml, or record m/s2", scale), evidence);
  };
  if (IsWithin(median, 1, 0.15) && mean.norm() > 0.7) return in_unit("imu_in_g", "g", kGravity);
  if (IsWithin(median, 1000, 0.15)) return in_unit("imu_in_mg", "mg", kGravity / 1000);
  if (IsWithin(median, 100 * kGravity, 0.05)) return in_unit("imu_in_cm", "cm/s2", 0.01);
  if (median < 3 && mean.norm() < 0.8 * median)
    return UnusableOf("imu_without_gravity",
                      "has gravity taken out of its accelerations, as it seems: " + measured,
                      "record the raw specific force, not a linear acceleration", evidence);
  if (median < 6 || median > 16)
    return UnusableOf(
        "imu_scale", "reads accelerations in no unit that is known: " + measured,
        FormatText("set accelerometer_scale: %.6g in imu0.yaml if it is a matter of scale",
                   kGravity / median),
        evidence);
  // What a car is pushed by cancels out on the way; what flies pulls g's.
  const double gain = (rig_.vehicle ? mean.norm() : median) / kGravity;
  const double off = std::abs(gain - 1);
  if (off <= (rig_.vehicle ? kUsualGain : kUsualGainInFlight)) return std::nullopt;
  Finding finding = WarningOf(
      kImuGain,
      FormatText("reads accelerations %.1f %% too %s, as it seems: %.3g m/s2 where "
                 "gravity alone makes 9.8",
                 100 * off, gain > 1 ? "large" : "small", gain * kGravity),
      FormatText("set accelerometer_scale: %.4g in imu0.yaml", rig_.imu.accelerometer_scale / gain),
      evidence);
  if (rig_.vehicle) {
    finding.sentence += FormatText("; they are used times %.4g", 1 / gain);
    finding.evidence[kGainCorrection] = 1 / gain;
  }
  return finding;
}

std::optional<Finding> ImuChecks::CheckGravity(const SpeedHistory& wheels) const {
  if (!rig_.vehicle) return std::nullopt;
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  for (const Bin& bin : bins_) up += bin.acceleration.cast<double>() / bin.count;
  up = (rig_.body_from_imu.rotation * up).normalized();
  const double angle = std::acos(std::clamp(up.z(), -1.0, 1.0)) / kDegree;
  const std::map<std::string, double> evidence = {{"angle_deg", angle}};
  if (angle > 150) {
    const std::optional<double> ratio = YawRatio(wheels);
    const bool is_turned = ratio && *ratio < 0;
    return UnusableOf(
        "imu_upside_down",
        is_turned ? "is mounted upside down, while the rig has it upright: gravity pulls toward "
                    "the car's roof"
                  : "is upside down against the rig, or its accelerations have the wrong sign: "
                    "gravity pulls toward the car's roof",
        is_turned
            ? "correct T_imu_body in vehicle.yaml and the cameras' extrinsics, which hang on it"
            : "a still, upright IMU reads +9.8 m/s2 upward; correct the driver's sign, or "
              "T_imu_body in vehicle.yaml",
        evidence);
  }
  if (angle > 30)
    return UnusableOf(
        "imu_mounting",
        "does not fit its mounting in the rig: gravity pulls toward the car's " + SideOf(-up),
        "correct T_imu_body in vehicle.yaml, or the order of the driver's axes", evidence);
  if (angle > 15)
    return WarningOf("imu_mounting",
                     FormatText("stands %.0f degrees aslant against the rig", angle),
                     "check T_imu_body in vehicle.yaml", evidence);
  return std::nullopt;
}

std::optional<double> ImuChecks::YawRatio(const SpeedHistory& wheels) const {
  constexpr double kMinTurning = 0.1;  // [rad^2/s], sum of squared rates over time
  double product = 0, square = 0;
  std::size_t hint = 0;
  for (const Bin& bin : bins_) {
    const std::optional<WheelSample> wheel = wheels.Near(bin.begin + 0.5 * kBin, hint);
    if (!wheel) continue;
    const double yaw_rate =
        (rig_.body_from_imu.rotation * (bin.rate.cast<double>() / bin.count)).z();
    product += yaw_rate * wheel->yaw_rate;
    square += wheel->yaw_rate * wheel->yaw_rate;
  }
  return square * kBin > kMinTurning ? std::optional(product / square) : std::nullopt;
}

std::optional<Finding> ImuChecks::CheckRates(const SpeedHistory& wheels) const {
  constexpr double kFastest = 3.5;  // [rad/s]; a car turns with 1.5 at most
  if (!rig_.vehicle) return std::nullopt;
  std::vector<double> rates;
  for (const Bin& bin : bins_) rates.push_back((bin.rate / static_cast<float>(bin.count)).norm());
  std::nth_element(rates.begin(),
                   rates.begin() + static_cast<std::ptrdiff_t>(rates.size() * 19 / 20),
                   rates.end());
  const double high = rates[rates.size() * 19 / 20];
  const std::optional<double> ratio = YawRatio(wheels);
  std::map<std::string, double> evidence = {{"rate_95_percent_rad_s", high}};
  if (ratio) evidence["yaw_rate_over_wheels"] = *ratio;
  const std::string measured = ratio
                                   ? FormatText("the car's turns are %.3g times those that %s see",
                                                *ratio, wheels.source().c_str())
                                   : FormatText("the car would turn with %.0f rad/s", high);
  if (ratio ? IsWithin(*ratio, 1 / kDegree, 0.3) : high > kFastest)
    return UnusableOf(
        "imu_in_degrees", "reads rates in deg/s, as it seems: " + measured,
        FormatText("set gyroscope_scale: %.9g in imu0.yaml, or record rad/s", kDegree), evidence);
  // The rates of wheels are used for nothing else, and may be in any unit themselves.
  if (ratio && ((*ratio > 0 && *ratio < 0.005) || high > kFastest))
    return UnusableOf(
        "gyroscope_scale", "reads rates in another unit than rad/s: " + measured,
        FormatText("set gyroscope_scale: %.4g in imu0.yaml if it is a matter of scale", 1 / *ratio),
        evidence);
  return std::nullopt;
}

std::optional<Finding> ImuChecks::CheckHeading(const SpeedHistory& wheels) const {
  constexpr double kMinPressing = 2;  // [m^2/s^3], sum of squared accelerations over time
  Eigen::Vector2d product = Eigen::Vector2d::Zero(), mean = Eigen::Vector2d::Zero();
  double square = 0, sum = 0, energy = 0, count = 0;
  std::size_t hint = 0;
  for (const Bin& bin : bins_) {
    const std::optional<WheelSample> wheel = wheels.Near(bin.begin + 0.5 * kBin, hint);
    if (!wheel || !rig_.vehicle) continue;
    const Eigen::Vector3d rate =
        rig_.body_from_imu.rotation * (bin.rate.cast<double>() / bin.count);
    const Eigen::Vector2d acceleration =
        (rig_.body_from_imu.rotation * (bin.acceleration.cast<double>() / bin.count)).head<2>();
    const double pressing = wheel->forward_speed * rate.z();  // toward the left in a left turn
    product += pressing * acceleration;
    mean += acceleration;
    square += pressing * pressing;
    energy += acceleration.squaredNorm();
    sum += pressing;
    ++count;
  }
  if (count == 0) return std::nullopt;
  // Without their means: a slope adds some gravity.
  product -= sum / count * mean;
  square -= sum * sum / count;
  energy -= mean.squaredNorm() / count;
  if (square * kBin < kMinPressing) return std::nullopt;
  const Eigen::Vector2d slope = product / square;  // of acceleration over pressing: (0, 1)
  const double angle = std::atan2(-slope.x(), slope.y()) / kDegree;
  const double correlation = product.norm() / std::sqrt(square * std::max(energy, 1e-9));
  if (std::abs(angle) < 45 || correlation < 0.6 || slope.norm() < 0.5 || slope.norm() > 2)
    return std::nullopt;
  const std::map<std::string, double> evidence = {{"angle_deg", angle},
                                                  {"correlation", correlation}};
  const std::optional<double> ratio = YawRatio(wheels);
  // Cameras that tell of no turns, where the IMU tells of them, do not tell of speeds either.
  if (!ratio && wheels.sigma() > 0) return std::nullopt;
  if (std::abs(angle) < 135)
    return UnusableOf(
        "imu_mounting",
        FormatText(
            "is turned by some %.0f degrees about the vertical against the rig, or its x and y "
            "have changed places: turns do not press toward their outside",
            std::round(angle)),
        "correct T_imu_body in vehicle.yaml, or the order of the driver's axes", evidence);
  // Reversed speeds of the wheels look the same, but for the turns that they report.
  if (!ratio || *ratio > -0.3) return std::nullopt;
  return UnusableOf("imu_left_handed",
                    "turns the other way than " + wheels.source() +
                        " and the accelerations say: its axes are left-handed, as it seems",
                    "correct the sign of the driver's rates", evidence);
}

std::optional<Finding> ImuChecks::CheckStuck(const SpeedHistory& wheels) const {
  constexpr double kMinWay = 15;  // [m], on which an IMU must have noticed something
  if (readings_.AreAllTheSame() && wheels.Length() > kMinWay)
    return UnusableOf(kImuStuck, "repeats one reading from beginning to end while the car moves",
                      "check its driver and its cable", {{kWay, wheels.Length()}});
  const std::vector<TimeSpan> spans = readings_.StuckSpans(wheels);
  if (spans.empty()) return std::nullopt;
  double seconds = 0;
  for (const TimeSpan& span : spans) seconds += span.Seconds();
  return WarningOf(
      kImuStuck,
      FormatText(
          "repeats one reading for %s while the car moves, first after %s: what it repeats is "
          "left out",
          DurationText(seconds).c_str(),
          DurationText(spans.front().begin - bins_.front().begin).c_str()),
      "check its driver and its cable", {{"seconds", seconds}});
}

}  // namespace parkade
