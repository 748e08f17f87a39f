#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/drive_log.h"
#include "core/rig.h"
#include "server/ingest/checks/finding.h"
#include "server/ingest/checks/imu_readings.h"
#include "server/ingest/checks/speed_history.h"

namespace parkade {

/// The finding about accelerations that are some percent off, and its evidence where they are
/// corrected, as a car's can be: what each has to be multiplied by.
inline constexpr const char *kImuGain = "imu_gain", *kGainCorrection = "correction";

/// The finding that all rates are zero, and its evidence: what wheels drove meanwhile [m].
inline constexpr const char *kImuWithoutRates = "imu_without_rates", *kWay = "way_m";

/// What an IMU says over a drive, in a few numbers per tenth of a second.
class ImuChecks {
 public:
  explicit ImuChecks(const Rig& rig) : rig_(rig) {}

  void Include(const ImuSample& sample);

  /// Units, gravity, mounting, halves that are missing, and what readings by themselves tell.
  /// \param wheels  what wheels said meanwhile; may be empty
  std::vector<Finding> Findings(const std::string& topic, const SpeedHistory& wheels) const;

  /// What is not to be used, where findings say so (kImuStuck).
  std::vector<TimeSpan> StuckSpans(const SpeedHistory& wheels) const {
    return readings_.StuckSpans(wheels);
  }

 private:
  /// The mean of some samples.
  struct Bin {
    Timestamp begin;
    int count = 0;
    Eigen::Vector3f rate = Eigen::Vector3f::Zero();          ///< [rad/s] in imu, a sum at first
    Eigen::Vector3f acceleration = Eigen::Vector3f::Zero();  ///< [m/s^2] alike
  };
  std::optional<Finding> CheckHalves(const SpeedHistory& wheels) const;
  /// Whether accelerations are of another size from some moment on.
  std::optional<Finding> CheckChange() const;
  std::optional<Finding> CheckAccelerations() const;
  std::optional<Finding> CheckGravity(const SpeedHistory& wheels) const;
  std::optional<Finding> CheckRates(const SpeedHistory& wheels) const;
  /// Whether the car's turns press toward the side that they should.
  std::optional<Finding> CheckHeading(const SpeedHistory& wheels) const;
  std::optional<Finding> CheckStuck(const SpeedHistory& wheels) const;
  /// Gyroscope's yaw rate over that of the wheels; nothing where the car hardly turned.
  std::optional<double> YawRatio(const SpeedHistory& wheels) const;

  const Rig& rig_;
  std::vector<Bin> bins_;
  ImuReadings readings_;
  std::uint64_t num_samples_ = 0, num_without_rate_ = 0, num_without_acceleration_ = 0;
  std::uint64_t num_lone_without_rate_ = 0;      ///< between two that have one
  std::array<bool, 2> had_rate_ = {true, true};  ///< the two samples before
};

}  // namespace parkade
