#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/site_map.h"
#include "server/ingest/checks/finding.h"
#include "server/pipeline/drive_diagnostics.h"
#include "server/pipeline/site_pins.h"
#include "slam/refinement/refine_drive.h"
#include "slam/sessions/join_drives.h"

namespace parkade {

/// Facts about one drive of a map that the map itself does not hold.
struct DriveOutcome {
  size_t log = 0;  ///< index among the logs that were given
  OdometryReport odometry;
  LoopClosure loops;
  LoopReview review;  ///< decisions that hold for them, of this build and of those before
  DriveRefinement refinement;
  DriveDiagnostics diagnostics;
  std::optional<GnssAlignment> gnss;
  size_t num_keyframes = 0;
  std::vector<Finding> findings = {};  ///< about the log, which only the trajectory tells
  int num_ground_images = 0;
};

/// A drive that was left out of the map.
struct LeftOutDrive {
  std::string name, reason;
  std::optional<size_t> log = {};  ///< index among the logs that BuildMap was given, where it has
                                   ///< odometry for the next version
  LoopReview review = {};
  std::vector<std::string> warnings = {};  ///< of its log
};

/// A map and how it came about.
struct BuiltMap {
  SiteMap site;
  std::vector<DriveOutcome> drives;  ///< as SiteMap::drives
  SitePinning pinning;
  DriveJoin join;                  ///< of all drives that have odometry
  std::vector<std::string> names;  ///< of these
  LinkReview link_review;          ///< decisions that hold, of this build and of those before
  std::vector<LeftOutDrive> left_out;
  std::vector<std::string> warnings;  ///< one sentence each
};

}  // namespace parkade
