#pragma once

#include <memory>
#include <span>
#include <vector>

#include "server/pipeline/build_context.h"
#include "server/pipeline/drive_in_work.h"
#include "server/pipeline/progress.h"

namespace parkade {

/// The odometry of each drive: taken from the map that the build starts from where that was made
/// from this log, with these options and streams; else tracked. It is kept among the products,
/// and its file's content is its key. One of several drives that cannot be tracked is left out.
/// Throws Error{kInvalidInput} where none can.
std::vector<DriveInWork> TrackDrives(std::span<const std::unique_ptr<RecordedDrive>> logs,
                                     const BuildContext& context, Progress& progress,
                                     std::vector<LeftOutDrive>& left_out);

}  // namespace parkade
