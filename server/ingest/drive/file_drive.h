#pragma once

#include <memory>
#include <string>

#include "server/ingest/drive/recorded_drive.h"

namespace parkade {

struct RecordedDriveParts;

/// A drive in files. Passes may go on at the same time, and may outlive this handle. The survey at
/// opening, which decodes no images, tells the health before the first pass.
class FileDrive final : public RecordedDrive {
 public:
  explicit FileDrive(std::shared_ptr<RecordedDriveParts> parts);

  const std::string& name() const override;
  const Rig& rig() const override;
  TimeSpan span() const override;
  std::unique_ptr<RecordStream> Read(const ReadOptions& options) const override;
  DriveLogHealth health() const override;

 private:
  std::shared_ptr<RecordedDriveParts> parts_;
};

}  // namespace parkade
