#pragma once

#include "core/drive_log.h"
#include "server/ingest/drive/drive_log_health.h"

namespace parkade {

/// A drive log that reports its losses.
class RecordedDrive : public DriveLog {
 public:
  /// The health of each stream as the last pass to its end found it; before that as opening the log
  /// did.
  virtual DriveLogHealth health() const = 0;
};

}  // namespace parkade
