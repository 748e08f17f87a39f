#pragma once

#include "core/drive_log.h"
#include "server/ingest/drive/drive_log_health.h"

namespace parkade {

/// A drive log that says what of it was lost.
class RecordedDrive : public DriveLog {
 public:
  /// As the last pass to its end found each stream; before that as opening it did.
  virtual DriveLogHealth health() const = 0;
};

}  // namespace parkade
