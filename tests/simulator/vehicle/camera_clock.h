#pragma once

#include <cstdint>
#include <vector>

#include "core/timestamp.h"
#include "tests/simulator/motion/motion.h"

namespace parkade::simulator {

/// When each camera takes its images: the rate is common, the phase is each camera's own.
struct CameraClockOptions {
  double rate = 20;        ///< [Hz]
  double jitter = 0.0008;  ///< [s] standard deviation of the intervals' ends, cut at three times
  double drop_probability = 0.003;  ///< share of images that get lost

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("rate", rate);
    visit("jitter", jitter);
    visit("drop_probability", drop_probability);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

struct ScheduledFrame {
  Timestamp time;  ///< middle of the exposure of the middle row
  size_t camera = 0;
};

/// Images of all cameras in order of time, between `margin` [s] after the start and before the end.
std::vector<ScheduledFrame> ScheduleFrames(const Motion& motion, size_t num_cameras,
                                           const CameraClockOptions& options, double margin,
                                           std::uint64_t seed);

}  // namespace parkade::simulator
