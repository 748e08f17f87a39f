#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/drive_log.h"
#include "core/rig.h"
#include "server/ingest/checks/camera_checks.h"
#include "server/ingest/checks/finding.h"
#include "server/ingest/checks/imu_checks.h"
#include "server/ingest/checks/speed_history.h"
#include "server/ingest/checks/wheel_checks.h"

namespace parkade {

/// The topics of a drive's streams; empty where it has none, or where it is not to be checked.
struct CheckedTopics {
  std::string imu, wheels, gnss;
  std::vector<std::string> cameras;  ///< by their indices in the rig
};

/// Cross-examines the samples of one drive: each stream by itself, and one against the other. What
/// only a trajectory can tell is told after odometry.
class LogChecks {
 public:
  explicit LogChecks(const Rig& rig) : rig_(rig), imu_(rig), cameras_(rig) {}

  // In order of time within each stream.
  void Include(const ImuSample& sample) {
    imu_.Include(sample);
    cameras_.Include(sample);
  }
  void Include(const WheelSample& sample) { wheels_.Include(sample); }
  void Include(const GnssFix& fix);
  CameraChecks& cameras() { return cameras_; }

  /// After all samples, and CameraChecks::FollowPairs.
  std::vector<Finding> Findings(const CheckedTopics& topics) const;

  /// When the IMU repeated one reading: what is not to be used.
  std::vector<TimeSpan> StuckImu() const { return imu_.StuckSpans(wheels_); }

 private:
  void CheckWheels(const std::string& topic, std::vector<Finding>& findings) const;
  /// Decides by the wheels' turns who of IMU, cameras and wheels is late or off.
  void CheckTurns(const std::string& wheels, std::vector<Finding>& findings) const;
  std::optional<Finding> CheckGnss(const std::string& topic) const;

  /// Speeds by wheels; by cameras where the drive has none.
  SpeedHistory Speeds() const;

  const Rig& rig_;
  ImuChecks imu_;
  CameraChecks cameras_;
  SpeedHistory wheels_;
  std::optional<GnssFix> first_fix_;
  double num_fixes_ = 0;
  double farthest_fix_ = 0;  ///< [m] from the first
};

/// Name of the finding about GNSS that is left out for it.
inline constexpr const char* kGnssIsFrozen = "gnss_frozen";

}  // namespace parkade
