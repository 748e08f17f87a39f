#pragma once

#include <memory>
#include <string>

#include "core/drive_log.h"
#include "server/ingest/drive/drive_log_health.h"

namespace parkade {

struct RecordedDriveParts;

/// A drive in files. Passes may go on at the same time, and may outlive this handle.
class RecordedDrive : public DriveLog {
 public:
  explicit RecordedDrive(std::shared_ptr<RecordedDriveParts> parts);

  const std::string& name() const override;
  const Rig& rig() const override;
  TimeSpan span() const override;
  std::unique_ptr<RecordStream> Read(const ReadOptions& options) const override;

  /// As the last pass to its end found each stream; before that as the survey at opening did, which decodes no images.
  DriveLogHealth health() const;

 private:
  std::shared_ptr<RecordedDriveParts> parts_;
};

}  // namespace parkade
