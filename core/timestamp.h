#pragma once

#include <compare>
#include <cstdint>
#include <string>

namespace parkade {

/// A point in time on the IMU's clock: integer nanoseconds, so that a stamp
/// survives every copy exactly. A difference of two stamps is in seconds.
struct Timestamp {
  std::int64_t ns = 0;

  auto operator<=>(const Timestamp&) const = default;

  double ToSeconds() const { return static_cast<double>(ns) * 1e-9; }
};

/// Nearest nanosecond to `seconds`; exact to about 200 ns for epoch times, so
/// use it for offsets and simulated clocks, not to parse text (see ParseSeconds).
Timestamp TimestampFromSeconds(double seconds);

/// Exact decimal form with nine digits, "1403715285.262142976".
std::string ToDecimalSeconds(Timestamp time);

/// Exact inverse of ToDecimalSeconds for any number of digits (beyond nine they
/// are cut). Throws Error{kInvalidInput} when `text` is not a decimal number.
Timestamp ParseSeconds(const std::string& text);

/// [s]
inline double operator-(Timestamp later, Timestamp earlier) {
  return static_cast<double>(later.ns - earlier.ns) * 1e-9;
}
Timestamp operator+(Timestamp time, double seconds);
inline Timestamp operator-(Timestamp time, double seconds) { return time + -seconds; }

/// Closed interval; empty while `end < begin`.
struct TimeSpan {
  Timestamp begin{0};
  Timestamp end{-1};

  bool IsEmpty() const { return end < begin; }
  bool Contains(Timestamp time) const { return begin <= time && time <= end; }
  double Seconds() const { return IsEmpty() ? 0.0 : end - begin; }
  void Include(Timestamp time) {
    if (IsEmpty()) begin = end = time;
    if (time < begin) begin = time;
    if (time > end) end = time;
  }
};

}  // namespace parkade
