#pragma once

#include <memory>
#include <span>

#include "server/ingest/drive/recorded_drive.h"
#include "server/pipeline/build_context.h"
#include "server/pipeline/built_map.h"
#include "server/pipeline/progress.h"

namespace parkade {

/// The program: recorded drives of one site in, one map out.
///
/// Each stage is a function from values to values; its product carries the key of all that it
/// depends on, so that a build that starts from a finished map takes what it can from there
/// (Cached). One of several drives that cannot be used or does not fit is left out, with a warning.
/// \param progress  has the stages of PlanStages
/// Throws Error as the stages do.
BuiltMap BuildMap(std::span<const std::unique_ptr<RecordedDrive>> logs, const MapOptions& options,
                  const BuildScope& scope, Progress& progress);

}  // namespace parkade
