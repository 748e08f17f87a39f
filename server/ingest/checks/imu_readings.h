#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/drive_log.h"
#include "server/ingest/checks/finding.h"
#include "server/ingest/checks/speed_history.h"

namespace parkade {

/// The finding about readings that a driver repeats while its sensor hangs.
inline constexpr const char* kImuStuck = "imu_stuck";

/// How an IMU's six readings are spaced, where they end, and whether they change at all.
class ImuReadings {
 public:
  void Include(const ImuSample& sample);

  /// Readings that never change, that come in coarse steps, or stick at the end of their range.
  /// \param way  [m] that wheels drove meanwhile: at rest an axis may read the same all the time
  std::vector<Finding> Findings(double way) const;

  /// Whether accelerations along x have more than a few values.
  bool AreAccelerationsVaried() const;

  bool AreAllTheSame() const { return num_samples_ >= 100 && num_repeats_ + 1 == num_samples_; }

  /// When all six readings stayed the same to the last bit for half a second or more while the car
  /// moved, though they hardly ever repeat otherwise.
  /// \param wheels  what wheels said meanwhile; may be empty
  std::vector<TimeSpan> StuckSpans(const SpeedHistory& wheels) const;

 private:
  /// One of the six readings.
  struct Axis {
    double first = 0;
    bool is_constant = true;
    double largest = 0;
    std::uint64_t num_largest = 0;      ///< readings that are as large
    std::vector<float> first_readings;  ///< to see how finely they are spaced
  };
  /// Samples in a row that are the same.
  struct Run {
    TimeSpan span;
    std::uint64_t num_repeats = 0;
    double rate = 0;  ///< [rad/s]
  };

  void IncludeInRun(const ImuSample& sample);
  static bool IsLong(const Run& run);
  bool IsSaturated(const Axis& axis, bool is_rate) const;
  bool HasMoved(double way) const;
  std::optional<Finding> CheckConstant(std::size_t axis) const;
  /// Whether samples are few, or come in packets with the stamp of their arrival.
  std::optional<Finding> CheckSteps() const;

  std::array<Axis, 6> axes_;  ///< rates, accelerations
  std::uint64_t num_samples_ = 0, num_repeats_ = 0;
  std::optional<ImuSample> last_;
  std::vector<float> first_steps_;  ///< [s] between samples
  Run run_;                         ///< the one that goes on
  std::vector<Run> long_runs_;
};

}  // namespace parkade
