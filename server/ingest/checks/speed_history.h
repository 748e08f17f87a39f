#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/drive_log.h"

namespace parkade {

/// What wheels say over a drive, or others in their place.
class SpeedHistory {
 public:
  SpeedHistory() = default;
  /// \param source  as sentences name it
  /// \param sigma   of a speed, as a share of it; 0: it is sure, but for a scale that all share
  SpeedHistory(std::string source, double sigma) : source_(std::move(source)), sigma_(sigma) {}

  const std::string& source() const { return source_; }
  double sigma() const { return sigma_; }

  void Include(const WheelSample& sample);

  const std::vector<WheelSample>& samples() const { return samples_; }
  bool empty() const { return samples_.empty(); }
  double Length() const { return length_; }  ///< [m] driven, forward or backward
  bool IsAlwaysZero() const { return length_ == 0; }

  /// The sample nearest to a time, within 0.1 s. Times must not decrease from call to call with the
  /// same `hint`.
  std::optional<WheelSample> Near(Timestamp time, std::size_t& hint) const;

 private:
  std::string source_ = "the wheels";
  double sigma_ = 0;
  std::vector<WheelSample> samples_;
  double length_ = 0;
};

}  // namespace parkade
