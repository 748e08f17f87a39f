#include "server/ingest/checks/imu_checks.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <set>

#include "core/statistics.h"

namespace parkade {
namespace {

constexpr double kGravity = 9.80665;  // [m/s^2]
constexpr double kBin = 0.1;          // [s]
constexpr std::size_t kMinBins = 10;  // fewer tell nothing
constexpr std::size_t kNumFirstReadings = 4000;
constexpr double kDegree = std::numbers::pi / 180;

template <typename... Values>
std::string Text(const char* format, Values... values) {
  char text[400];
  std::snprintf(text, sizeof(text), format, values...);
  return text;
}

Finding Unusable(std::string name, std::string sentence, std::string advice,
                 std::map<std::string, double> evidence) {
  return {std::move(name),     Severity::kUnusable, "",
          std::move(sentence), std::move(advice),   std::move(evidence)};
}

Finding Warning(std::string name, std::string sentence, std::string advice,
                std::map<std::string, double> evidence) {
  return {std::move(name),     Severity::kWarning, "",
          std::move(sentence), std::move(advice),  std::move(evidence)};
}

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

/// The step between readings: their smallest difference, where they are many and few are distinct.
std::optional<double> StepOf(const std::vector<float>& readings) {
  const std::set<float> distinct(readings.begin(), readings.end());
  if (readings.size() < 500 || distinct.size() < 2 || distinct.size() > 24) return std::nullopt;
  double step = INFINITY;
  for (auto it = std::next(distinct.begin()); it != distinct.end(); ++it)
    step = std::min(step, static_cast<double>(*it) - *std::prev(it));
  return step;
}

}  // namespace

void ImuChecks::Include(const ImuSample& sample) {
  ++num_samples_;
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

  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i % 3);
    const double reading = i < 3 ? sample.angular_velocity[at] : sample.linear_acceleration[at];
    Axis& axis = axes_[i];
    if (std::abs(reading) > axis.largest)
      axis = {std::abs(reading), 0, std::move(axis.first_readings)};
    if (std::abs(reading) == axis.largest) ++axis.num_largest;
    if (axis.first_readings.size() < kNumFirstReadings)
      axis.first_readings.push_back(static_cast<float>(reading));
  }
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
  const bool is_wrong =
      add(CheckHalves()) || add(CheckAccelerations()) || add(CheckGravity(wheels));
  if (!add(CheckRates(wheels)) && !is_wrong) add(CheckHeading(wheels));
  CheckReadings(findings);
  for (Finding& finding : findings) {
    finding.topic = topic;
    finding.sentence = "the IMU " + topic + " " + finding.sentence;
  }
  return findings;
}

std::optional<Finding> ImuChecks::CheckHalves() const {
  const auto all = static_cast<double>(num_samples_);
  const double without_acceleration = static_cast<double>(num_without_acceleration_) / all,
               without_rate = static_cast<double>(num_without_rate_) / all,
               lone = static_cast<double>(num_lone_without_rate_) / all;
  if (num_without_acceleration_ == num_samples_)
    return Unusable(
        "imu_without_accelerations",
        "holds no accelerations: all of them are zero, as in a topic of a gyroscope alone",
        "record accelerations and rates in one sensor_msgs/Imu",
        {{"share_without_acceleration", 1}});
  const std::vector<float>& x = axes_[3].first_readings;
  const bool accelerations_vary = std::set<float>(x.begin(), x.end()).size() > 10;
  if (num_without_rate_ == num_samples_ && accelerations_vary)
    return Unusable("imu_without_rates",
                    "holds no rates: all of them are zero, as in a topic of an accelerometer alone",
                    "record accelerations and rates in one sensor_msgs/Imu",
                    {{"share_without_rate", 1}});
  if (without_acceleration > 0.02 || lone > 0.2)
    return Unusable(
        "imu_in_halves",
        Text("holds halves: %.0f %% of its messages have no acceleration, %.0f %% no rates",
             100 * without_acceleration, 100 * without_rate),
        "join both sensors' messages into one sensor_msgs/Imu of both",
        {{"share_without_acceleration", without_acceleration},
         {"share_without_rate", without_rate}});
  return std::nullopt;
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
  const std::string measured = Text("%.3g m/s2 where gravity alone makes 9.8", median);
  const auto in_unit = [&](const char* name, const char* unit, double scale) {
    return Unusable(
        name, std::string("reads accelerations in ") + unit + ", as it seems: " + measured,
        Text("set accelerometer_scale: %.6g in imu0.yaml, or record m/s2", scale), evidence);
  };
  if (IsWithin(median, 1, 0.15) && mean.norm() > 0.7) return in_unit("imu_in_g", "g", kGravity);
  if (IsWithin(median, 1000, 0.15)) return in_unit("imu_in_mg", "mg", kGravity / 1000);
  if (IsWithin(median, 100 * kGravity, 0.05)) return in_unit("imu_in_cm", "cm/s2", 0.01);
  if (median < 3)
    return Unusable("imu_without_gravity",
                    "has gravity taken out of its accelerations, as it seems: " + measured,
                    "record the raw specific force, not a linear acceleration", evidence);
  if (median < 6 || median > 16)
    return Unusable("imu_scale", "reads accelerations in no unit that is known: " + measured,
                    Text("set accelerometer_scale: %.6g in imu0.yaml if it is a matter of scale",
                         kGravity / median),
                    evidence);
  const double tolerance = rig_.vehicle ? 0.04 : 0.15;  // what flies pulls g's
  if (!IsWithin(median, kGravity, tolerance))
    return Warning("imu_gain",
                   Text("reads accelerations %.2f times too large, as it seems: %s",
                        median / kGravity, measured.c_str()),
                   Text("set accelerometer_scale: %.4g in imu0.yaml", kGravity / median), evidence);
  return std::nullopt;
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
    return Unusable(
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
    return Unusable(
        "imu_mounting",
        "does not fit its mounting in the rig: gravity pulls toward the car's " + SideOf(-up),
        "correct T_imu_body in vehicle.yaml, or the order of the driver's axes", evidence);
  if (angle > 15)
    return Warning("imu_mounting", Text("stands %.0f degrees aslant against the rig", angle),
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
  if (const std::optional<double> ratio = rig_.vehicle ? YawRatio(wheels) : std::nullopt) {
    const std::map<std::string, double> evidence = {{"yaw_rate_over_wheels", *ratio}};
    const std::string measured = Text("the car's turns are %.3g times those of its wheels", *ratio);
    if (IsWithin(*ratio, 1 / kDegree, 0.3))
      return Unusable("imu_in_degrees", "reads rates in deg/s, as it seems: " + measured,
                      Text("set gyroscope_scale: %.9g in imu0.yaml, or record rad/s", kDegree),
                      evidence);
    // The rates of wheels are used for nothing else, and may be in any unit themselves.
    if (*ratio > 0 && *ratio < 0.005)
      return Unusable(
          "gyroscope_scale", "reads rates in another unit than rad/s: " + measured,
          Text("set gyroscope_scale: %.4g in imu0.yaml if it is a matter of scale", 1 / *ratio),
          evidence);
  }
  std::vector<double> rates;
  for (const Bin& bin : bins_) rates.push_back((bin.rate / static_cast<float>(bin.count)).norm());
  std::nth_element(rates.begin(),
                   rates.begin() + static_cast<std::ptrdiff_t>(rates.size() * 19 / 20),
                   rates.end());
  const double high = rates[rates.size() * 19 / 20];
  if (rig_.vehicle && high > 3.5)  // a car turns with 1.5 rad/s at most
    return Unusable(
        "imu_in_degrees",
        Text("reads rates in deg/s, as it seems: the car would turn with %.0f rad/s", high),
        Text("set gyroscope_scale: %.9g in imu0.yaml, or record rad/s", kDegree),
        {{"rate_95_percent_rad_s", high}});
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
  if (std::abs(angle) < 135)
    return Unusable(
        "imu_mounting",
        Text("is turned by some %.0f degrees about the vertical against the rig, or its x and y "
             "have changed places: turns do not press toward their outside",
             std::round(angle)),
        "correct T_imu_body in vehicle.yaml, or the order of the driver's axes", evidence);
  // Reversed speeds of the wheels look the same, but for the turns that they report.
  const std::optional<double> ratio = YawRatio(wheels);
  if (!ratio || *ratio > -0.3) return std::nullopt;
  return Unusable("imu_left_handed",
                  "turns the other way than the wheels and the accelerations say: its axes are "
                  "left-handed, as it seems",
                  "correct the sign of the driver's rates", evidence);
}

void ImuChecks::CheckReadings(std::vector<Finding>& findings) const {
  static constexpr const char* kNames[6] = {"rate about x",         "rate about y",
                                            "rate about z",         "acceleration along x",
                                            "acceleration along y", "acceleration along z"};
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const Axis& axis = axes_[i];
    const char* unit = i < 3 ? "rad/s" : "m/s2";
    const double coarse = i < 3 ? 0.01 : 0.15;
    const std::optional<double> step = StepOf(axis.first_readings);
    if (step && *step > coarse) {
      findings.push_back(Warning("imu_resolution",
                                 Text("has a %s in steps of %.3g %s only", kNames[i], *step, unit),
                                 "set a smaller range of the sensor", {{"step", *step}}));
      continue;
    }
    const auto share = static_cast<double>(axis.num_largest) / static_cast<double>(num_samples_);
    const double large = i < 3 ? 0.3 : 11;
    if (axis.num_largest >= 10 && share > 0.002 && share < 0.5 && axis.largest > large)
      findings.push_back(Warning(
          "imu_saturated",
          Text("reads exactly %.4g %s as %s %llu times: it is at the end of its range",
               axis.largest, unit, kNames[i], static_cast<unsigned long long>(axis.num_largest)),
          "set a larger range of the sensor", {{"largest", axis.largest}}));
  }
}

}  // namespace parkade
