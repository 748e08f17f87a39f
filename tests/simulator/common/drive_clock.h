#pragma once

#include <cstdint>
#include <vector>

#include "core/timestamp.h"

namespace parkade::simulator {

/// When the simulated clock's second 0 is.
Timestamp DriveEpoch(std::uint64_t seed);

/// From `phase` [s] on at `rate` [Hz], up to `duration` [s].
std::vector<Timestamp> Ticks(double duration, double rate, double phase, std::uint64_t seed);

}  // namespace parkade::simulator
