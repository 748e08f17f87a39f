#pragma once

#include <vector>

#include "slam/odometry/calibrated_log.h"

namespace parkade {

/// A drive as if its car had another calibration, and only some of its cameras:
/// nothing has to be recorded or rendered again. Images left out are not decoded.
class ReriggedLog final : public DriveLog {
 public:
  /// `log` is borrowed. `rig` has the cameras of log.rig(), in their order;
  /// `cameras` are indices of those to keep, in the order they get; empty: all.
  ReriggedLog(const DriveLog& log, const Rig& rig, std::vector<int> cameras);

  const std::string& name() const override { return calibrated_.name(); }
  const Rig& rig() const override { return rig_; }
  TimeSpan span() const override { return calibrated_.span(); }
  std::unique_ptr<RecordStream> Read(const ReadOptions& options) const override;

 private:
  CalibratedLog calibrated_;
  std::vector<int> cameras_;
  std::vector<int> new_index_;  ///< per camera of the recorded rig; -1: left out
  Rig rig_;
};

}  // namespace parkade
