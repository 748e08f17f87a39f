#include "server/ingest/checks/log_checks.h"

#include <algorithm>
#include <cmath>

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

}  // namespace

void LogChecks::Include(const GnssFix& fix) {
  ++num_fixes_;
  if (!first_fix_) first_fix_ = fix;
  farthest_fix_ = std::max(farthest_fix_, DistanceBetween(*first_fix_, fix));
}

std::optional<Finding> LogChecks::CheckWheels(const std::string& topic) const {
  if (topic.empty() || wheels_.empty() || !wheels_.IsAlwaysZero()) return std::nullopt;
  return Finding{kWheelsAreZero,
                 Severity::kWarning,
                 topic,
                 "the wheels " + topic + " say 0 m/s from beginning to end and are left out",
                 "check that the encoders are connected, and that the speed is in twist.linear.x",
                 {}};
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

std::vector<Finding> LogChecks::Findings(const CheckedTopics& topics) const {
  std::vector<Finding> findings = imu_.Findings(topics.imu, wheels_);
  if (const auto found = CheckWheels(topics.wheels)) findings.push_back(*found);
  if (const auto found = CheckGnss(topics.gnss)) findings.push_back(*found);
  // Cameras are held against IMU and wheels, which must not be wrong themselves.
  if (findings.empty()) return cameras_.Findings(wheels_, topics.cameras);
  return findings;
}

}  // namespace parkade
