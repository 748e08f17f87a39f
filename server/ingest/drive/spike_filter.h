#pragma once

#include <optional>

#include "server/ingest/drive/timestamp_filter.h"

namespace parkade {

/// Leaves out single samples of an IMU that lie far from both neighbors, which lie near each other:
/// bits that flipped on a bus. Samples come one later than they went in.
class SpikeFilter {
 public:
  struct Result {
    std::optional<Arrival> good;
    bool is_spike = false;  ///< one was left out
  };

  /// \param arrival  an ImuSample, in order of time
  Result Push(Arrival arrival);

  /// Call at the end: the last one.
  std::optional<Arrival> Finish();

 private:
  std::optional<ImuSample> last_;  ///< that was passed on
  std::optional<Arrival> held_;
};

}  // namespace parkade
