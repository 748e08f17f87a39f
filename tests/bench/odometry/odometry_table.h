#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "slam/odometry/odometry_options.h"
#include "tests/bench/suite/suite_drive.h"

namespace parkade {

/// What the odometry is given of a drive. Written as CAMERAS[-wheels]-RIG:
/// CAMERAS is "four" or one camera's name; RIG is "exact", "nominal" (as the drive's
/// owner knows it), an angle in degrees by which each camera is off (with a place
/// off by 10 cm / 3 per degree), or "stamps" (exact but for stamps off by up to 30 ms).
struct TableVariant {
  std::string name;
  std::string camera;  ///< empty: all of them
  bool has_wheels = false;
  std::string rig = "exact";
  double rotation_deg = 0;    ///< where the rig is off by an angle
  double translation_cm = 0;  ///< where the rig is off by a length
};

/// Throws Error{kUsage} for a name that is no variant.
TableVariant ParseVariant(const std::string& name);

/// Those that the goals speak of.
std::vector<std::string> StandardVariants();

/// The rig that a variant is given for a drive. The seed is the drive's own: the same
/// drive has the same errors in every variant, larger or smaller.
Rig RigOfVariant(const TableVariant& variant, const SuiteDrive& drive);

/// One drive, one variant, and what came of it.
struct TableRun {
  std::string drive, scene, variant;
  std::string error;                            ///< why there is no answer; empty: there is one
  double length = 0, duration = 0;              ///< [m], [s]
  double ate = 0, drift_percent = 100;          ///< [m] after rigid alignment
  double coverage = 0;                          ///< share of the log
  double rotation_deg = 0, translation_mm = 0;  ///< error of the worst camera after the drive
  double released_deg = 0, released_mm = 0;  ///< the same error of quantities reported as refined
  int num_released = 0;                      ///< of rotations and translations
  double time_offset_ms = 0;                 ///< error of the worst camera after the drive
  double wall_seconds = 0, peak_memory_mb = 0;  ///< of the run
  double start_seconds = 0;                     ///< into the log, until the start was found
  std::string start_kind;
  std::vector<double> noise_scales;       ///< per camera
  std::vector<std::string> degraded;      ///< "12.0-13.5 s: reason", seconds into the log
  std::vector<TimedPose> world_from_imu;  ///< moved onto the truth; not in the JSON
};

/// No answer, or a drift above 5 %.
bool IsFailure(const TableRun& run);

/// Runs the odometry. An error of the log is part of the answer; other errors are thrown.
TableRun RunVariant(const SuiteDrive& drive, const TableVariant& variant,
                    const OdometryOptions& options);

nlohmann::json ToJson(const TableRun& run);
TableRun TableRunFromJson(const nlohmann::json& json);

}  // namespace parkade
