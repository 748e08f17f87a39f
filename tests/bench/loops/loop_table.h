#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "slam/loops/close_loops.h"
#include "slam/odometry/odometry_drift.h"
#include "slam/refinement/refine_drive.h"
#include "tests/bench/loops/wrong_loops.h"
#include "tests/bench/odometry/odometry_table.h"

namespace parkade {

/// An accepted loop against the truth.
struct LoopError {
  double translation = 0;  ///< [m]
  double rotation = 0;     ///< [rad]
  double squared =
      0;  ///< [sigma^2] by the loop's own information, per number that it measures: 1 is honest
  int num_inliers = 0;
  bool is_opposite = false;  ///< the car stood the other way around
  double height = 0;         ///< [m] between the two keyframes in truth
  Vector6d error = Vector6d::Zero(),
           sigmas = Vector6d::Zero();  ///< RelativePoseError and what is claimed of it
  double earlier = 0, later = 0;       ///< [s] of the drive
};

/// The worst camera of a rig against the true one.
struct MountError {
  double rotation = 0;     ///< [rad]
  double translation = 0;  ///< [m]
};

/// One drive, one way to close its loops, and what came of it.
struct LoopRun {
  std::string drive, scene,
      method;         ///< method: none, pnp, scale-less, rotation-only, rig, rig+refine
  double length = 0;  ///< [m]
  double ate = 0, drift_percent = 0;
  int num_candidates = 0, num_measured = 0;  ///< measured: before the pose graph had its say
  std::vector<LoopError> accepted;
  int num_wrong = 0;  ///< accepted loops farther off than anything could excuse
  int num_opposite_chances = 0,
      num_opposite_found = 0;  ///< keyframes that were passed before the other way around
  double seconds = 0;          ///< of closing loops or refining
  double odometry_seconds = 0, duration = 0;  ///< of tracking; of the drive
  MountError mount_error;      ///< of the cameras as found by odometry, or by the refinement
  OdometryDrift drift;         ///< as the odometry claims it
  MixedLoops mixed;            ///< of the way "rig", where wrong loops were asked for
  double mixed_ate = 0;        ///< [m] with them
  DriveRefinement refinement;  ///< of rig+refine
};

/// What a table is made with.
struct LoopTableOptions {
  OdometryOptions odometry;
  LoopOptions loops;
  RefinementOptions refinement;
  bool refines = true;     ///< adjusts the whole drive too, after "none" and "rig"
  bool uses_gnss = false;  ///< in the refinement
  WrongLoopOptions wrong;  ///< that are mixed in among those of "rig"

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("odometry", odometry);
    visit("loops", loops);
    visit("refinement", refinement);
    visit("refines", refines);
    visit("uses_gnss", uses_gnss);
    visit("wrong", wrong);
  }
};

/// A drive as one variant of the odometry's table sees it, tracked.
struct TrackedDrive {
  std::unique_ptr<DriveLog> log;
  OdometryResult odometry;
};

/// Tracks the drive with the variant's rig. Where `kept` is not empty, the odometry is read from
/// that file, or written there.
TrackedDrive TrackDrive(const SuiteDrive& drive, const TableVariant& variant,
                        const OdometryOptions& options, const std::filesystem::path& kept);

/// Closes the drive's loops in each of the ways; where options.refines, what "rig" made and the
/// odometry alone are refined too.
std::vector<LoopRun> RunLoops(const SuiteDrive& drive, const TrackedDrive& tracked,
                              const std::vector<std::string>& methods,
                              const LoopTableOptions& options);

nlohmann::json ToJson(const LoopRun& run);

/// A table like the paper's, one row per drive, and what it adds up to.
std::string ToMarkdown(const std::vector<LoopRun>& runs);

/// Histograms of the accepted loops' errors, one row per method: translation and rotation. CV_8UC3,
/// for people.
cv::Mat PlotLoopErrors(const std::vector<LoopRun>& runs);

}  // namespace parkade
