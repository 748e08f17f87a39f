#include "tests/simulator/common/drive_clock.h"

namespace parkade::simulator {

Timestamp DriveEpoch(std::uint64_t seed) {
  constexpr std::int64_t kNewYear2026 = 1'767'225'600, kSecond = 1'000'000'000;
  return {(kNewYear2026 + static_cast<std::int64_t>(seed % 8760) * 3600) * kSecond};
}

std::vector<Timestamp> Ticks(double duration, double rate, double phase, std::uint64_t seed) {
  std::vector<Timestamp> ticks;
  for (int i = 0;; ++i) {
    const double time = phase + i / rate;
    if (time > duration) return ticks;
    ticks.push_back(DriveEpoch(seed) + time);
  }
}

}  // namespace parkade::simulator
