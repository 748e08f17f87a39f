#pragma once

#include <vector>

#include "core/drive_log.h"

namespace parkade {

/// A drive with another calibration of the same cameras: images and masks come at the times that
/// its time shifts say, still in order of time.
class CalibratedLog final : public DriveLog {
 public:
  /// `log` is borrowed. `rig` has the cameras of log.rig(), in their order.
  CalibratedLog(const DriveLog& log, Rig rig);

  const std::string& name() const override { return log_.name(); }
  const Rig& rig() const override { return rig_; }
  TimeSpan span() const override { return log_.span(); }
  std::unique_ptr<RecordStream> Read(const ReadOptions& options) const override;

 private:
  const DriveLog& log_;
  Rig rig_;
  std::vector<double> shifts_;  ///< [s] per camera, by which images are later than `log_` says
};

}  // namespace parkade
