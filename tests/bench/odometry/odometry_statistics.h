#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "slam/odometry/odometry_options.h"
#include "slam/odometry/odometry_result.h"
#include "tests/bench/odometry/pose_consistency.h"
#include "tests/simulator/tracks/track_drive.h"

namespace parkade {

/// One question to the odometry, asked with many seeds.
struct StatisticsCase {
  std::string name;
  simulator::TrackDriveOptions drive;  ///< the seed is set per run
  OdometryOptions odometry;
  /// Where the record begins: "standing", "rolling", "turning".
  std::string start = "standing";
};

/// One drive and the odometry's answer.
struct StatisticsRun {
  int seed = 0;
  std::string error;  ///< why there is no answer; empty: there is one
  std::string start_kind;
  double length = 0, duration = 0;  ///< [m], [s] of the record
  double ate = 0;                   ///< [m] after rigid alignment
  double drift_percent = 100;
  std::vector<PoseConsistency>
      consistency;                  ///< at a quarter, half, three quarters and the end of the drive
  double rotation_error_deg = 0;    ///< of the cameras' mounting after the drive: greatest
  double translation_error_cm = 0;  ///< of the worst camera's mounting
  double time_offset_error_ms = 0;  ///< of the worst camera
  double wheel_scale_error = 0;     ///< estimated / true - 1
  double start_seconds = 0;         ///< of data that the start took
  double coverage = 0;              ///< share of the record that the trajectory covers
  double noise_scale = 0;           ///< greatest of the cameras'
  double making_seconds = 0, making_ms_per_image = 0, estimating_seconds = 0;
};

/// Makes the drive and estimates it. Throws only for options that cannot be.
StatisticsRun RunOnce(const StatisticsCase& question, int seed);

/// All runs of a case, in order of seeds from 1, in parallel.
std::vector<StatisticsRun> RunCase(const StatisticsCase& question, int num_runs);

/// Feeds a drive without images to the estimator, as EstimateTrajectory feeds one with images.
OdometryResult EstimateTrackDrive(const simulator::TrackDrive& drive,
                                  const OdometryOptions& options);

/// No answer, or a drift above 5 %.
bool IsFailure(const StatisticsRun& run);

/// Means over the runs that gave an answer, where nothing else is said.
struct StatisticsSummary {
  int num_answers = 0, num_failures = 0, num_consistent = 0;  ///< the last: with a covariance
  double mean_drift = 0, median_drift = 0, worst_drift = 0;   ///< [%]
  /// NEES per degree of freedom at the end of the drive, and at the four times.
  double nees_pose = 0, nees_rotation = 0, nees_position = 0, nees_on_the_way = 0;
  ConfidenceBounds nees_bounds;  ///< of nees_pose, for an honest estimator
  double rotation_error_deg = 0, translation_error_cm = 0, time_offset_error_ms = 0;
  double wheel_scale_error = 0;  ///< of its size
  double start_seconds = 0, coverage = 0;
  double speed_ratio = 0;   ///< seconds of drive per second of estimating, tracks made before
  double ms_per_image = 0;  ///< of making tracks
};
StatisticsSummary Summarize(const std::vector<StatisticsRun>& runs);

/// A line per case.
std::string TableHead();
std::string TableLine(const std::string& name, const std::vector<StatisticsRun>& runs);
nlohmann::json ToJson(const StatisticsCase& question, const std::vector<StatisticsRun>& runs);

}  // namespace parkade
