#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/timestamp.h"
#include "server/ingest/checks/finding.h"
#include "server/ingest/containers/raw_message.h"

namespace parkade {

/// Why a record did not reach the estimator.
enum class DropReason {
  kDamaged,           ///< the message or the image cannot be decoded
  kRepeated,          ///< same stamp as the record before
  kBackwardStamp,     ///< stamp before that of the record before
  kOffClock,          ///< stamp far from the IMU's clock, or a lone jump
  kNotFinite,         ///< NaN, infinite or out of any sensor's range
  kStuck,             ///< a reading that a driver repeats while its sensor hangs
  kNoFix,             ///< GNSS without a position
  kLate,              ///< further behind the other streams than the reordering window
  kWrongSize,         ///< image of another size than calibrated
  kWaitsForKeyFrame,  ///< image of a video before the first that can be decoded by itself
};
inline constexpr std::size_t kNumDropReasons = 10;

/// "damaged", "repeated", "backward_stamp", ...
const char* NameOf(DropReason reason);

/// The records that one stream delivered in one pass, and those that it did not.
struct StreamHealth {
  std::string topic;
  std::string role;  ///< "imu", "wheels", "gnss", a camera's name, or that with "/semantic"
  std::uint64_t num_delivered = 0;
  std::array<std::uint64_t, kNumDropReasons> num_dropped{};
  double off_clock_by = 0;  ///< [s] how far the first that was off the IMU's clock lay ahead of it
  TimeSpan span;            ///< of the records on the drive's clock
  double longest_gap = 0;   ///< [s] between two of them
  Timestamp longest_gap_begin;

  std::uint64_t& Dropped(DropReason reason) {
    return num_dropped[static_cast<std::size_t>(reason)];
  }
  std::uint64_t Dropped(DropReason reason) const {
    return num_dropped[static_cast<std::size_t>(reason)];
  }
  std::uint64_t NumDropped() const;

  /// Counts a record at `time` as one on the drive's clock.
  void Include(Timestamp time);
};

/// State of a drive log as its last passes found it.
struct DriveLogHealth {
  std::vector<StreamHealth> streams;
  DamageReport damage;            ///< of the container
  std::vector<Finding> findings;  ///< none that makes it unusable

  std::vector<std::string> Warnings() const { return WarningsOf(findings); }
};

nlohmann::json HealthToJson(const DriveLogHealth& health);

}  // namespace parkade
