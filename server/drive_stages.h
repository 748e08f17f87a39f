#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/drive_log.h"
#include "server/map_options.h"
#include "server/stage_products.h"
#include "slam/join_drives.h"
#include "slam/odometry_result.h"
#include "slam/refine_drive.h"

namespace parkade {

/// The stages that look at one drive, or at two, each done once for the same inputs: results are taken from the map
/// that the build starts from, so that a drive that joins a site of many costs its own work. A result that was taken
/// says that it took no seconds.
class DriveStages {
 public:
  /// \param from, to  as of StageProducts
  DriveStages(const std::filesystem::path& from, std::filesystem::path to, const MapOptions& options);

  /// Whether results are kept for later builds.
  bool keeps_products() const { return products_.is_kept(); }

  /// `odometry_file`: where the drive's odometry is stored; its content stands for the drive. Called once per drive,
  /// before the others; what follows names a drive by `log.name()`.
  void Begin(const DriveLog& log, const std::filesystem::path& odometry_file);

  LoopClosure CloseLoops(const DriveLog& log, const OdometryResult& odometry, const LoopReview& review);
  /// After its loops are closed.
  DriveRefinement Refine(const DriveLog& log, const OdometryResult& odometry, const LoopClosure& loops);
  /// Along the refined drive, `log` being as the refinement found it to be.
  std::vector<Place> FindPlaces(const DriveLog& log, const OdometryResult& odometry, const DriveRefinement& refinement);
  /// For drives in the order of `names`, of which `drives` says how they stand.
  PairMemory MemoryOfPairs(const std::vector<std::string>& names, const std::vector<DriveToJoin>& drives) const;

 private:
  StageProducts products_;
  const MapOptions& options_;
  std::map<std::string, std::string> keys_;  // per drive: of all its stages so far
};

}  // namespace parkade
