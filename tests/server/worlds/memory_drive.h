#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/ingest/drive/recorded_drive.h"
#include "tests/support/synthetic_motion.h"

namespace parkade {

/// A drive log in memory.
class MemoryDrive final : public RecordedDrive {
 public:
  /// \param records  in order of time
  MemoryDrive(std::string name, Rig rig, std::vector<SensorRecord> records);

  const std::string& name() const override { return name_; }
  const Rig& rig() const override { return rig_; }
  TimeSpan span() const override;
  std::unique_ptr<RecordStream> Read(const ReadOptions& options) const override;
  DriveLogHealth health() const override;

 private:
  std::string name_;
  Rig rig_;
  std::vector<SensorRecord> records_;
};

/// CarMotion through a textured hall for `duration` seconds, as an exact IMU at 200 Hz, wheels at
/// 50 Hz and two fisheyes of 320x200 at 5 Hz see it. Frame `world` is that of CarMotion.
std::unique_ptr<RecordedDrive> DriveThroughHall(const std::string& name, double duration);

/// A log of an IMU alone for `duration` seconds: nothing can be tracked.
std::unique_ptr<RecordedDrive> DriveWithoutImages(const std::string& name, double duration);

}  // namespace parkade
