#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/drive_log.h"
#include "mapping/heights/drive_heights.h"
#include "server/map_folder/ground_file.h"
#include "server/map_folder/stage_products.h"
#include "server/pipeline/map_options.h"
#include "slam/odometry/odometry_result.h"
#include "slam/refinement/refine_drive.h"
#include "slam/sessions/join_drives.h"

namespace parkade {

/// The stages that look at one drive, or at two, each done once for the same inputs: results are taken from the map
/// that the build starts from, so that a drive that joins a site of many costs its own work. A result that was taken
/// says that it took no seconds.
class DriveStages {
 public:
  /// \param from, to  as of StageProducts
  DriveStages(const std::filesystem::path& from, std::filesystem::path to, const MapOptions& options);

  /// `odometry_file`: where the drive's odometry is stored; its content stands for the drive. Called once per drive,
  /// before the others; what follows names a drive by `log.name()`.
  void Begin(const DriveLog& log, const std::filesystem::path& odometry_file);

  LoopClosure CloseLoops(const DriveLog& log, const OdometryResult& odometry, const LoopReview& review);
  /// After its loops are closed.
  DriveRefinement Refine(const DriveLog& log, const OdometryResult& odometry, const LoopClosure& loops);
  /// Along the refined drive, `log` being as the refinement found it to be.
  std::vector<Place> FindPlaces(const DriveLog& log, const OdometryResult& odometry, const DriveRefinement& refinement);
  /// The same, but they are only kept: few are in memory at a time.
  void KeepPlaces(const DriveLog& log, const OdometryResult& odometry, const DriveRefinement& refinement);
  /// What the drive sees of the ground, in the map's folder. `log` as for places; `drive_submaps` are the drive's.
  std::shared_ptr<const GroundFile> ObserveGround(const DriveLog& log, const OdometryResult& odometry,
                                                  std::span<const Submap> drive_submaps);
  /// What it knows of the ground's height; `drive` is its number in the site. After ObserveGround.
  DriveHeights MeasureHeights(const DriveLog& log, const std::shared_ptr<const GroundFile>& ground,
                              const DriveRefinement& refinement, int drive);
  /// For drives in the order of `names`, of which `drives` says how they stand.
  PairMemory MemoryOfPairs(const std::vector<std::string>& names, const std::vector<DriveToJoin>& drives) const;

 private:
  std::string KeyOfPlaces(const DriveLog& log);
  void EncodePlacesAlong(const DriveLog& log, const OdometryResult& odometry, const DriveRefinement& refinement,
                         const PieceSink& sink) const;

  /// What results of a drive depend on.
  struct Keys {
    std::string odometry, ground;
    std::string refinement;  ///< with the loops before it
    std::string so_far;      ///< of all stages that lead to links
  };

  std::filesystem::path from_, to_;
  StageProducts products_;
  const MapOptions& options_;
  std::map<std::string, Keys> keys_;  // per drive
};

}  // namespace parkade
