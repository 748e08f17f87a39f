#pragma once

namespace parkade {

/// The largest whole number that is not above x, which must fit an int. Without SSE 4.1 std::floor
/// is a call: too slow for what is asked of every sample.
inline int FastFloor(double x) {
  const int truncated = static_cast<int>(x);
  return truncated - (x < truncated ? 1 : 0);
}

/// value / divisor, rounded down; the divisor is > 0.
inline int FloorDivide(int value, int divisor) {
  return (value - (value < 0 ? divisor - 1 : 0)) / divisor;
}

}  // namespace parkade
