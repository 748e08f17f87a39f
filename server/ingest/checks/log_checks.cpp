#include "server/ingest/checks/log_checks.h"

#include <algorithm>
#include <cmath>

#include "server/ingest/checks/gyroscope_findings.h"

namespace parkade {
namespace {

constexpr double kDegreeOnEarth = 111'000;  // [m] roughly, of latitude
constexpr double kMinWay = 15;              // [m] driven, that a receiver must have noticed
constexpr double kFrozen = 0.05;            // [m]

double DistanceBetween(const GnssFix& a, const GnssFix& b) {
  const double north = (b.latitude_deg - a.latitude_deg) * kDegreeOnEarth;
  const double east = (b.longitude_deg - a.longitude_deg) * kDegreeOnEarth *
                      std::cos(a.latitude_deg * 0.017453292519943295);
  return std::hypot(north, east);
}

/// Noises that no IMU has, in which a trajectory trusts too much. The best of ships and aircraft
/// have ten times these.
std::optional<Finding> CheckNoises(const ImuCalibration& imu, const std::string& topic) {
  constexpr double kLeast[4] = {1e-6, 1e-7, 1e-7, 1e-9};
  const std::pair<const char*, double> noises[4] = {
      {"accelerometer_noise_density", imu.accelerometer_noise_density},
      {"accelerometer_random_walk", imu.accelerometer_random_walk},
      {"gyroscope_noise_density", imu.gyroscope_noise_density},
      {"gyroscope_random_walk", imu.gyroscope_random_walk}};
  for (std::size_t i = 0; i < 4; ++i)
    if (const auto& [name, value] = noises[i]; value < kLeast[i])
      return Finding{"imu_noise_too_small",
                     Severity::kWarning,
                     topic,
                     "the rig gives the IMU " + topic + " a " + name + " that none has",
                     "take its data sheet's, or those of a consumer's IMU: 0.02, 0.001, 0.001, "
                     "0.00001",
                     {{name, value}}};
  return std::nullopt;
}

}  // namespace

void LogChecks::Include(const GnssFix& fix) {
  ++num_fixes_;
  if (!first_fix_) first_fix_ = fix;
  farthest_fix_ = std::max(farthest_fix_, DistanceBetween(*first_fix_, fix));
}

void LogChecks::CheckWheels(const std::string& topic, std::vector<Finding>& findings) const {
  for (const auto& found : {CheckSpeeds(wheels_, topic),
                            CheckSticking(wheels_, cameras_.NumMovingAtRest(wheels_), topic)})
    if (found) {
      findings.push_back(*found);
      return;
    }
  CheckTurns(topic, findings);
}

void LogChecks::CheckTurns(const std::string& wheels, std::vector<Finding>& findings) const {
  for (const Finding& finding : findings)
    if (finding.name == kImuStuck || finding.severity == Severity::kUnusable) return;
  const auto turns = FitWheelDelay(rig_, cameras_.gyroscope(), wheels_);
  double imu_delay = 0;
  for (Finding& finding : findings) {
    // Wheels are with the IMU or with the cameras; without a word of theirs the IMU is the clock,
    // and its rates stay as they are.
    if (finding.name == kImuLate) {
      imu_delay = finding.evidence.at(kDelay);
      if (turns && std::abs(turns->seconds + imu_delay) < std::abs(turns->seconds)) continue;
      finding = AsDelayOfCameras(finding, !wheels_.empty());
      imu_delay = 0;
    } else if (finding.name == kGyroscopeGain && turns) {
      const double gain = finding.evidence.at(kRateCorrection);
      if (std::abs(turns->gain - gain) > std::abs(turns->gain - 1)) {
        finding = AsErrorOfLenses(finding);
      } else {
        finding.sentence += ", and so by its wheels; rates are used times that";
        finding.evidence[kIsCorrected] = 1;
      }
    }
  }
  if (!turns) return;
  if (const auto found = CheckWheelDelay(*turns, imu_delay, wheels)) findings.push_back(*found);
}

std::optional<Finding> LogChecks::CheckGnss(const std::string& topic) const {
  const double way = wheels_.Length();
  if (num_fixes_ < 3 || farthest_fix_ > kFrozen || way < kMinWay) return std::nullopt;
  return Finding{kGnssIsFrozen,
                 Severity::kWarning,
                 topic,
                 "the fixes of " + topic + " stay at one spot while the car drives " +
                     std::to_string(std::lround(way)) + " m, and are left out",
                 "check the receiver, and that its messages are not repeated by a driver",
                 {{"way_m", way}, {"farthest_fix_m", farthest_fix_}}};
}

SpeedHistory LogChecks::Speeds() const { return wheels_.empty() ? cameras_.Speeds() : wheels_; }

std::vector<Finding> LogChecks::Findings(const CheckedTopics& topics) const {
  const SpeedHistory speeds = Speeds();
  std::vector<Finding> findings = imu_.Findings(topics.imu, speeds);
  const auto gnss = CheckGnss(topics.gnss);
  if (gnss) findings.push_back(*gnss);
  // Cameras are held against IMU and wheels, which must not be wrong themselves.
  const bool is_sound = std::all_of(findings.begin(), findings.end(), [](const Finding& finding) {
    return finding.severity == Severity::kNote;
  });
  if (is_sound)
    for (Finding& finding : cameras_.Findings(speeds, topics.cameras, topics.imu))
      findings.push_back(std::move(finding));
  CheckWheels(topics.wheels, findings);
  for (Finding& finding : cameras_.CheckNoise(topics.cameras))
    findings.push_back(std::move(finding));
  if (const auto found = CheckNoises(rig_.imu, topics.imu)) findings.push_back(*found);
  return findings;
}

}  // namespace parkade
