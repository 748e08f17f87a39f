#pragma once

#include <memory>
#include <mutex>
#include <string>

#include "core/rig.h"
#include "server/ingest/containers/raw_message.h"
#include "server/ingest/drive/drive_log_health.h"
#include "server/ingest/drive/intact_images.h"
#include "server/ingest/drive/log_survey.h"

namespace parkade {

/// The state that a RecordedDrive and its passes share.
struct RecordedDriveParts {
  std::string name;
  Rig rig;
  std::shared_ptr<const MessageSource> source;
  LogSurvey survey;  ///< its streams are the drive's
  int num_decode_threads = 1;
  IntactImages intact;  ///< as found by passes so far

  std::mutex health_mutex;
  DriveLogHealth health;  ///< guarded by health_mutex
};

}  // namespace parkade
