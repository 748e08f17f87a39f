#pragma once

#include <optional>
#include <vector>

#include "core/drive_log.h"

namespace parkade {

/// What wheels say over a drive.
class SpeedHistory {
 public:
  void Include(const WheelSample& sample);

  bool empty() const { return samples_.empty(); }
  double Length() const { return length_; }  ///< [m] driven, forward or backward
  bool IsAlwaysZero() const { return length_ == 0; }

  /// The sample nearest to a time, within 0.1 s. Times must not decrease from call to call with the
  /// same `hint`.
  std::optional<WheelSample> Near(Timestamp time, std::size_t& hint) const;

 private:
  std::vector<WheelSample> samples_;
  double length_ = 0;
};

}  // namespace parkade
