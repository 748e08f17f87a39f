#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace parkade {

constexpr float kComparable = 0.5F;      ///< of the best sight's rank: a sight that has a say beside it
constexpr float kEarlierShare = 0.125F;  ///< of its rank: what a sight keeps once a later drive shows the place

/// A colour of the ground in one image, and how well it was seen.
struct ColorSight {
  std::uint8_t blue = 0, green = 0, red = 0;
  std::uint8_t rank = 0;  ///< 1 to 255; 0: none
};

/// The best few sights of a place, best first.
template <std::size_t N>
class BestSights {
 public:
  bool empty() const { return sights_[0].rank == 0; }
  const ColorSight& operator[](std::size_t i) const { return sights_[i]; }

  /// Whether a sight of this rank would be kept.
  bool Wants(std::uint8_t rank) const { return rank > sights_.back().rank; }

  void Add(const ColorSight& sight) {
    if (!Wants(sight.rank)) return;
    std::size_t slot = N - 1;
    for (; slot > 0 && sights_[slot - 1].rank < sight.rank; --slot) sights_[slot] = sights_[slot - 1];
    sights_[slot] = sight;
  }

  /// A later drive shows the place. Days differ in light: what was seen before keeps kEarlierShare of its rank.
  void StepBack() {
    for (ColorSight& sight : sights_)
      if (sight.rank > 0)
        sight.rank = static_cast<std::uint8_t>(std::max(1.0F, kEarlierShare * static_cast<float>(sight.rank)));
  }

  /// How many of the first have a say beside the best.
  std::size_t CountComparable() const {
    const float least = std::max(1.0F, kComparable * static_cast<float>(sights_[0].rank));
    std::size_t count = 0;
    while (count < N && static_cast<float>(sights_[count].rank) >= least) ++count;
    return count;
  }

 private:
  std::array<ColorSight, N> sights_{};
};

}  // namespace parkade
