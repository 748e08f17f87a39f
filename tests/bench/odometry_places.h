#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "slam/odometry_options.h"
#include "tests/simulator/track_drive.h"

namespace parkade {

/// One drive through one place, made anew with other noise: all cameras together beside each of them alone.
struct PlaceCase {
  std::string name;                    ///< "SCENE:SEED[:START]"
  std::string start = "standing";      ///< or "rolling", "turning"
  simulator::TrackDriveOptions drive;  ///< the noise's seed is set per run
};

/// Of "street:7" or "garage:3:rolling", `duration` [s] long, without wheels and GNSS. Throws Error{kUsage}.
PlaceCase ParsePlace(const std::string& name, double duration);

/// Turns and moves every mount: "exact", or degrees as "0.3" and "1", with 1 cm and 3 cm. Throws Error{kUsage}.
void SetRigError(const std::string& rig, simulator::TrackDriveOptions& drive);

/// What one camera of a drive sees, with the rig, tracks and noise that it had among the others.
simulator::TrackDrive OneCamera(const simulator::TrackDrive& drive, size_t camera);

/// One drive with one noise. Errors are those of all cameras together first, then of each alone.
struct PlaceRun {
  std::string place, rig;
  int noise_seed = 0;
  double length = 0;                  ///< [m]
  std::vector<double> drift_percent;  ///< kNoAnswer where there is none
  std::vector<double> scale_percent;  ///< too long by; 0 where there is no answer
};
inline constexpr double kNoAnswer = 100;  ///< [%] of drift

PlaceRun RunPlace(const PlaceCase& place, const std::string& rig, int noise_seed, const OdometryOptions& odometry);

/// What the runs of one place and one rig say.
struct PlaceSummary {
  size_t num_runs = 0;
  std::vector<double> rms_drift;  ///< [%] over the runs: all cameras, then each alone
  std::vector<double> rms_scale;  ///< [%] likewise
  size_t best = 0;                ///< the single camera with the smallest rms_drift: 1..
  double ratio = 0;               ///< rms of all over that of `best`
  double low = 0, high = 0;       ///< 95 % of such ratios among resampled runs, each with its own best camera
  double near_luckiest = 0;       ///< share of runs in which all are at most 5 % worse than the luckiest camera
};

/// \param runs  at least one, of the same number of cameras. Deterministic.
PlaceSummary SummarizePlace(const std::vector<PlaceRun>& runs);

nlohmann::json ToJson(const PlaceRun& run);
PlaceRun PlaceRunFromJson(const nlohmann::json& json);  ///< throws nlohmann::json::exception

/// A table in Markdown: a row per place and rig, in order of their first run.
std::string PlaceTable(const std::vector<PlaceRun>& runs);

}  // namespace parkade
