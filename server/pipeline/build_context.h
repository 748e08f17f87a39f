#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/map_folder/map_reader.h"
#include "server/map_folder/stage_cache.h"
#include "server/pipeline/built_map.h"
#include "server/pipeline/map_options.h"

namespace parkade {

/// How far to build, and what is known before.
struct BuildScope {
  bool is_odometry_only = false;  ///< trajectories, no surface
  std::filesystem::path from;     ///< finished map whose stages' products are taken where they fit
  LogHashes logs;  ///< by drive: products in `from` that were made from another log are not taken
  std::filesystem::path products;  ///< folder in which products are kept; empty: none, no surface
  std::filesystem::path work;      ///< folder where they are kept, too, for a next try; empty: none
  std::filesystem::path preview;   ///< .glb that shows the map before it is done; empty: none
  std::map<std::string, LoopReview> loops;  ///< what a reviewer decided, by drive
  LinkReview links;                         ///< the same, between drives
  std::vector<SitePin> pins;                ///< where points of the site lie on Earth
  std::vector<LeftOutDrive> unreadable;     ///< logs that are left out from the beginning
};

/// The values that all stages of one build share.
struct BuildContext {
  BuildContext(const MapOptions& map_options, const BuildScope& build_scope);

  const MapOptions& options;
  const BuildScope& scope;
  StageCache cache;
  std::optional<MapReader> from;  ///< nothing where the build starts anew
};

}  // namespace parkade
