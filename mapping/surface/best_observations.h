#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace parkade {

constexpr float kComparable =
    0.5F;  ///< of the best observation's rank: an observation that has a say beside it
constexpr float kEarlierShare =
    0.125F;  ///< of its rank: what an observation keeps once a later drive shows the place

/// A color of the ground in one image, and how well it was seen.
struct ColorObservation {
  std::uint8_t blue = 0, green = 0, red = 0;
  std::uint8_t rank = 0;  ///< 1 to 255; 0: none
};

/// The best few observations of a place, best first.
template <std::size_t N>
class BestObservations {
 public:
  bool empty() const { return observations_[0].rank == 0; }
  const ColorObservation& operator[](std::size_t i) const { return observations_[i]; }

  /// Whether an observation of this rank would be kept.
  bool Wants(std::uint8_t rank) const { return rank > observations_.back().rank; }

  void Add(const ColorObservation& observation) {
    if (!Wants(observation.rank)) return;
    std::size_t slot = N - 1;
    for (; slot > 0 && observations_[slot - 1].rank < observation.rank; --slot)
      observations_[slot] = observations_[slot - 1];
    observations_[slot] = observation;
  }

  /// A later drive shows the place. Days differ in light: what was seen before keeps kEarlierShare
  /// of its rank.
  void StepBack() {
    for (ColorObservation& observation : observations_)
      if (observation.rank > 0)
        observation.rank = static_cast<std::uint8_t>(
            std::max(1.0F, kEarlierShare * static_cast<float>(observation.rank)));
  }

  /// How many of the first have a say beside the best.
  std::size_t CountComparable() const {
    const float least = std::max(1.0F, kComparable * static_cast<float>(observations_[0].rank));
    std::size_t count = 0;
    while (count < N && static_cast<float>(observations_[count].rank) >= least) ++count;
    return count;
  }

 private:
  std::array<ColorObservation, N> observations_{};
};

}  // namespace parkade
