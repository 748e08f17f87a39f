#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "slam/odometry/odometry_options.h"
#include "slam/refinement/refinement_options.h"
#include "tests/simulator/tracks/track_drive.h"

namespace parkade {

/// One drive through one place, made anew with other noise: all cameras together beside each of
/// them alone.
struct PlaceCase {
  std::string name;                    ///< "SCENE:SEED[:START]"
  std::string start = "standing";      ///< or "rolling", "turning"
  simulator::TrackDriveOptions drive;  ///< the noise's seed is set per run
};

/// Makes the drive "street:7" or "garage:3:rolling", `duration` [s] long, without wheels and GNSS.
/// Throws Error{kUsage}.
PlaceCase ParsePlace(const std::string& name, double duration);

/// Turns and moves every mount: "exact", or degrees as "0.3" and "1", with 1 cm and 3 cm. Throws
/// Error{kUsage}.
void SetRigError(const std::string& rig, simulator::TrackDriveOptions& drive);

/// What one camera of a drive sees, with the rig, tracks and noise that it had among the others.
simulator::TrackDrive OneCamera(const simulator::TrackDrive& drive, size_t camera);

/// One drive with one noise. Errors are those of all cameras together first, then of each alone.
struct PlaceRun {
  std::string place, rig;
  std::string estimator = kOdometry;  ///< or kWholeDrive
  int noise_seed = 0;
  double length = 0;                  ///< [m]
  std::vector<double> drift_percent;  ///< kNoAnswer where there is none
  std::vector<double> scale_percent;  ///< too long by; 0 where there is no answer
  /// [%^2] mean inner products of the errors of position of each two estimates, n x n by rows,
  /// after rigid alignment; the diagonal is drift_percent squared, but for the choice of moments.
  /// Empty where one has no answer.
  std::vector<double> error_products;

  static constexpr const char* kOdometry = "odometry";
  static constexpr const char* kWholeDrive = "whole drive";
};
inline constexpr double kNoAnswer = 100;  ///< [%] of drift

/// The refinement with everything that odometry measured: all tracks at all their observations, no
/// held-out ones, its result taken whatever it is. What a window loses, it does not.
RefinementOptions WholeDriveOptions();

/// What is asked of each drive.
struct PlaceEstimators {
  OdometryOptions odometry;
  std::optional<RefinementOptions> whole_drive;  ///< odometry adjusted by it, too, without loops
};

/// \return a run of the odometry and, where asked for, one of the whole drive's adjustment
std::vector<PlaceRun> RunPlace(const PlaceCase& place, const std::string& rig, int noise_seed,
                               const PlaceEstimators& estimators);

/// What the runs of one place, rig and estimator say.
struct PlaceSummary {
  size_t num_runs = 0;
  std::vector<double> rms_drift;  ///< [%] over the runs: all cameras, then each alone
  std::vector<double> rms_scale;  ///< [%] of the scale
  size_t best = 0;                ///< the single camera with the smallest rms_drift: 1..
  double ratio = 0;               ///< rms of all over that of `best`
  double low = 0,
         high = 0;  ///< 95 % of such ratios among resampled runs, each with its own best camera
  double near_luckiest =
      0;  ///< share of runs in which all are at most 5 % worse than the luckiest camera
  /// Share of `best` in that mixture of its positions with those of all which has the least error
  /// over the runs. An estimate that makes the best of all measurements wants nothing of an
  /// estimate from some of them: 0 but for chance, since its error is uncorrelated with the
  /// difference of the two (A. Gelb, "Applied optimal estimation", 1974, section 4.2,
  /// orthogonality). Above 0, all leave something unused that `best` has.
  double wanted_share = 0;
};

/// \param runs  at least one, of the same number of cameras. Deterministic.
PlaceSummary SummarizePlace(const std::vector<PlaceRun>& runs);

nlohmann::json ToJson(const PlaceRun& run);
PlaceRun PlaceRunFromJson(const nlohmann::json& json);  ///< throws nlohmann::json::exception

/// A table in Markdown: a row per place, rig and estimator, in order of their first run.
std::string PlaceTable(const std::vector<PlaceRun>& runs);

}  // namespace parkade
