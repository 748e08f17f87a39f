#pragma once

#include <memory>

#include "server/ingest/drive/recorded_drive.h"
#include "server/pipeline/build_context.h"
#include "server/pipeline/progress.h"

namespace parkade {

/// Finds all that a drive needs by itself, whatever it is joined with, and keeps it in
/// `scope.work`, where a build of its site takes it: so that drives can be prepared beside each
/// other. Throws Error{kInvalidInput} where the drive cannot be tracked.
void PrepareDrive(const std::unique_ptr<RecordedDrive>& log, const MapOptions& options,
                  const BuildScope& scope, Progress& progress);

}  // namespace parkade
