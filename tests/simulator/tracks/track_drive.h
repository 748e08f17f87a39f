#pragma once

#include <cstdint>
#include <vector>

#include "core/drive_log.h"
#include "core/trajectory.h"
#include "slam/odometry/odometry_options.h"
#include "tests/simulator/drives/simulate_drive.h"
#include "tests/simulator/tracks/track_model.h"

namespace parkade::simulator {

/// A drive as parkade-simulate makes it, by the same scene, driver, traffic, sensors
/// and faults, but without images. Faults of recorders (time jumps, duplicates,
/// disorder, damaged images) are the log reader's business and not of track mode.
struct TrackDriveOptions {
  SimulateOptions drive;  ///< what concerns images alone is not looked at
  double begin = 0;       ///< [s] the record begins here: > 0 rolling, or in mid-turn
  int noise_seed = -1;    ///< of sensors, clocks, tracks and the rig's errors; -1: the drive's.
                          ///< Place, path, traffic and true rig stay
  TrackModel model;

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("drive", drive);
    visit("begin", begin);
    visit("noise_seed", noise_seed);
    visit("model", model);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

/// What one camera saw in one image.
struct SeenImage {
  TrackedFrame frame;                       ///< own tracks; stamped as the odometry would see it
  std::vector<FeatureObservation> crossed;  ///< tracks of other cameras found in it,
  double pair_seconds = 0;                  ///< in images at most this far apart
};

struct TrackDrive {
  Rig rig;       ///< as the odometry is told
  Rig true_rig;  ///< as it was at the beginning
  std::vector<ImuSample> imu;
  std::vector<WheelSample> wheels;
  std::vector<SeenImage> images;  ///< of all cameras, in order of stamps
  std::vector<TimedPose> truth;   ///< world_from_body at 100 Hz, on the IMU's clock
  double length = 0;              ///< [m]
  double seconds_per_image = 0;   ///< that making the tracks took
};

/// Same options, same drive (but for seconds_per_image). `odometry` says how many tracks and
/// whether to match across cameras. Throws Error{kUsage} for options that cannot be.
TrackDrive MakeTrackDrive(const TrackDriveOptions& options, const OdometryOptions& odometry = {});

/// A moment [s] of the drive that suits a start: `is_turning` wants a yaw rate of at least 0.2
/// rad/s, else at least 2 m/s straight ahead. 0 when there is none in the first half.
double FindMovingStart(const TrackDriveOptions& options, bool is_turning);

}  // namespace parkade::simulator
