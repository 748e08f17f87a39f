#include "tests/simulator/vehicle/camera_clock.h"

#include <algorithm>

#include "core/error.h"
#include "tests/simulator/common/drive_clock.h"
#include "tests/simulator/common/random.h"

namespace parkade::simulator {

void CameraClockOptions::Validate() const {
  Require(rate > 0 && rate <= 120, ErrorCode::kUsage,
          "the cameras' rate must be above 0 and at most 120 Hz");
  Require(jitter >= 0 && 8 * jitter < 1 / rate, ErrorCode::kUsage,
          "the cameras' jitter must be less than an eighth of their interval");
  Require(drop_probability >= 0 && drop_probability < 1, ErrorCode::kUsage,
          "the drop probability must be 0 or more and below 1");
}

std::vector<ScheduledFrame> ScheduleFrames(const Motion& motion, size_t num_cameras,
                                           const CameraClockOptions& options, double margin,
                                           std::uint64_t seed) {
  std::vector<ScheduledFrame> frames;
  for (size_t camera = 0; camera < num_cameras; ++camera) {
    Random random(seed, 0xca0 + camera);
    const double phase = margin + random.Uniform() / options.rate;
    for (double tick = phase; tick < motion.Duration() - margin - 3 * options.jitter;
         tick += 1 / options.rate) {
      const double jitter = options.jitter * std::clamp(random.Normal(), -3.0, 3.0);
      const bool is_lost = random.Chance(options.drop_probability);
      if (!is_lost) frames.push_back({DriveEpoch(seed) + std::max(margin, tick + jitter), camera});
    }
  }
  std::sort(frames.begin(), frames.end(), [](const ScheduledFrame& a, const ScheduledFrame& b) {
    return std::pair(a.time, a.camera) < std::pair(b.time, b.camera);
  });
  return frames;
}

}  // namespace parkade::simulator
