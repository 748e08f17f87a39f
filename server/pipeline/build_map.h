#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/site_map.h"
#include "server/ingest/drive/recorded_drive.h"
#include "server/map_folder/finished_map.h"
#include "server/pipeline/map_options.h"
#include "server/pipeline/progress.h"
#include "server/pipeline/site_pins.h"
#include "slam/refinement/refine_drive.h"
#include "slam/sessions/join_drives.h"

namespace parkade {

/// What is known about one drive of a map beyond the map itself.
struct DriveOutcome {
  size_t log = 0;  ///< index among the logs that were given
  OdometryReport odometry;
  LoopClosure loops;
  LoopReview review;  ///< decisions that hold for them, of this build and of those before
  DriveRefinement refinement;
  std::optional<GnssAlignment> gnss;
  size_t num_keyframes = 0;
  int num_ground_images = 0;
};

/// A drive that the map is made without.
struct LeftOutDrive {
  std::string name, reason;
  std::optional<size_t> log = {};  ///< of those that BuildMap was given, where it has odometry for the next version
  LoopReview review = {};
};

/// A map and how it came about.
struct BuiltMap {
  SiteMap site;
  std::vector<DriveOutcome> drives;  ///< as SiteMap::drives
  SitePinning pinning;
  DriveJoin join;                  ///< of all drives that have odometry
  std::vector<std::string> names;  ///< of these
  std::vector<LeftOutDrive> left_out;
  std::vector<std::string> warnings;  ///< one sentence each
};

/// A drive whose loops have just been closed.
struct ClosedDrive {
  std::string name;
  Rigid3 body_from_imu;
  const Trajectory* odometry = nullptr;
  const LoopClosure* loops = nullptr;
  bool is_odometry_taken = false;  ///< from the map that the build starts from
};

/// The stages that BuildMap goes through, for Progress.
std::vector<StagePlan> PlanStages(size_t num_drives, bool is_odometry_only);

/// How much of the way to go.
struct BuildScope {
  bool is_odometry_only = false;  ///< trajectories, no surface
  std::filesystem::path from;  ///< finished map whose odometry, and stages (DriveStages), are taken where it has them
  LogHashes logs;  ///< of the drives: what `from` has of a drive that was made from another log is not taken
  std::filesystem::path products;  ///< folder in which both are stored per drive; empty: not stored, no surface then
  std::map<std::string, LoopReview> loops;                      ///< what a reviewer decided, by drive
  std::vector<SitePin> pins;                                    ///< where points of the site lie on Earth
  std::vector<LeftOutDrive> unreadable;                         ///< logs that are left out from the beginning
  std::function<void(std::span<const ClosedDrive>)> on_closed;  ///< called once all drives' loops are closed
  std::function<void(const SiteMap&)> on_placed;  ///< called once trajectories are final, before there is ground
};

/// The program: recorded drives of one place in, one map out.
///
/// Drives are joined by places that both passed and by GNSS (JoinDrives). One of several that cannot be used or does
/// not fit is left out, with a warning. Throws what the stages throw.
BuiltMap BuildMap(const std::vector<std::unique_ptr<RecordedDrive>>& logs, const MapOptions& options,
                  const BuildScope& scope, Progress& progress);

}  // namespace parkade
