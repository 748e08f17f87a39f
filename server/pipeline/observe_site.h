#pragma once

#include <vector>

#include "server/pipeline/drive_stages.h"
#include "server/pipeline/progress.h"

namespace parkade {

/// The ground as all drives saw it, and where they drove, in the site.
struct SiteGround {
  std::vector<Keyed<std::shared_ptr<const GroundFile>>> files;  ///< by drive, as all that follows
  StoredGround patches;
  std::vector<DrivenPath> paths;
  std::vector<DriveHeights> heights;  ///< none for methods that do not use them
};

/// Observes the ground of the joined drives, which are those of `built`, and measures its height.
SiteGround ObserveSite(const BuildContext& context, const std::vector<DriveInWork>& drives,
                       Progress& progress, BuiltMap& built);

}  // namespace parkade
