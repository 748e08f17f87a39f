#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/timestamp.h"

namespace parkade {

/// What one of a table's stamps counts.
enum class StampUnit { kNanoseconds, kMicroseconds, kMilliseconds, kSeconds };

/// "nanoseconds", ...
const char* NameOf(StampUnit unit);

/// A stamp as tables write it: "1403715273262142976", "1403715273.262142976", "1.403715273262e+18"
/// in `unit`, to the nanosecond where the digits say it; or, in any unit, a date of UTC,
/// "2011-09-26 13:02:25.964389445". Nothing for anything else.
std::optional<Timestamp> ParseStamp(std::string_view text, StampUnit unit);

/// The unit of stamps that follow each other in a table, told by what makes them dates of this
/// century and the steps between them those of a sensor; nanoseconds where that leaves it open, or
/// seconds where they have decimals.
/// \param min_step, max_step  [s] that the sensor may have
StampUnit UnitOf(const std::vector<std::string>& stamps, double min_step, double max_step);

}  // namespace parkade
