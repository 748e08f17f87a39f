#pragma once

#include <cmath>
#include <cstdint>

namespace parkade::simulator {

/// Bijective mixing of 64 bits. G. Steele et al., "Fast Splittable Pseudorandom Number Generators",
/// OOPSLA 2014.
inline std::uint64_t Mix64(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

/// A seed for one part of what comes from `seed`: no part of another seed has it. (seed + part
/// would: decks of one garage had the floors of the next seed's.)
inline std::uint64_t SeedOfPart(std::uint64_t seed, std::uint64_t part) {
  return Mix64(seed) + part;
}

/// Random numbers that are the same with every compiler and library, unlike
/// std's distributions. Streams of one seed are independent of each other, so
/// that one more draw in one sensor leaves all others as they were.
class Random {
 public:
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0)
      : state_(Mix64(Mix64(seed) ^ (stream * 0x9e6d62d06f6a9a9bULL))) {}

  std::uint64_t Bits() { return Mix64(state_++); }

  /// In [0, 1).
  double Uniform() { return static_cast<double>(Bits() >> 11) * 0x1.0p-53; }
  double Uniform(double low, double high) { return low + (high - low) * Uniform(); }

  /// In [0, count).
  int Index(int count) { return static_cast<int>(Bits() % static_cast<std::uint64_t>(count)); }
  bool Chance(double probability) { return Uniform() < probability; }

  /// Standard normal (Box-Muller).
  double Normal() {
    const double radius = std::sqrt(-2 * std::log(1 - Uniform()));
    return radius * std::cos(2 * M_PI * Uniform());
  }

 private:
  std::uint64_t state_;
};

}  // namespace parkade::simulator
