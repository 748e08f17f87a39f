#pragma once

#include <cmath>
#include <cstdint>

namespace parkade::simulator {

/// Largest whole number not above `x`, as std::floor, for |x| < 2^31; compiles to two instructions
/// everywhere.
inline int FastFloorToInt(float x) {
  const int truncated = static_cast<int>(x);
  return truncated - (static_cast<float>(truncated) > x);
}

/// 32 hashed bits of a lattice cell.
inline std::uint32_t HashCell(int x, int y, std::uint32_t seed) {
  std::uint32_t h = static_cast<std::uint32_t>(x) * 0x8da6b343u +
                    static_cast<std::uint32_t>(y) * 0xd8163841u + seed * 0xcb1ab31fu;
  h = (h ^ (h >> 16)) * 0x7feb352du;
  h = (h ^ (h >> 15)) * 0x846ca68bu;
  return h ^ (h >> 16);
}

/// The noise of a cell, in [-1, 1].
inline float CellValue(int x, int y, std::uint32_t seed) {
  return static_cast<float>(HashCell(x, y, seed) >> 8) * (2.0f / 16777215.0f) - 1.0f;
}

/// Value noise in [-1, 1] with lattice constant 1, C1-smooth.
inline float SmoothNoise(float x, float y, std::uint32_t seed) {
  const int ix = FastFloorToInt(x), iy = FastFloorToInt(y);
  const float fx = x - static_cast<float>(ix), fy = y - static_cast<float>(iy);
  const float sx = fx * fx * (3 - 2 * fx), sy = fy * fy * (3 - 2 * fy);
  const float bottom = CellValue(ix, iy, seed) * (1 - sx) + CellValue(ix + 1, iy, seed) * sx;
  const float top = CellValue(ix, iy + 1, seed) * (1 - sx) + CellValue(ix + 1, iy + 1, seed) * sx;
  return bottom * (1 - sy) + top * sy;
}

/// Sum of `octaves` of SmoothNoise, halving wavelength and amplitude, in about [-1, 1].
inline float FractalNoise(float x, float y, int octaves, std::uint32_t seed) {
  float sum = 0, amplitude = 0.5f;
  for (int octave = 0; octave < octaves; ++octave) {
    sum += amplitude * SmoothNoise(x, y, seed + static_cast<std::uint32_t>(octave));
    amplitude *= 0.5f;
    x = 2.03f * x + 17.1f;
    y = 2.03f * y - 9.7f;
  }
  return sum;
}

/// 0 below `low`, 1 above `high`, C1-smooth between.
inline float SmoothStep(float low, float high, float x) {
  const float t = std::fmin(1.0f, std::fmax(0.0f, (x - low) / (high - low)));
  return t * t * (3 - 2 * t);
}

}  // namespace parkade::simulator
