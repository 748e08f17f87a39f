#pragma once

#include <array>
#include <cstdint>

#include "mapping/surface/best_observations.h"

namespace parkade {

/// What a cell of the ground looks like: the nearest observations of it. The latest drive that saw
/// it well decides alone.
class CellColor {
 public:
  /// \param observation     ranked by nearness
  /// \param is_first  of its drive in this cell; drives come one after the other, the latest last
  void Add(const ColorObservation& observation, bool is_first);

  bool empty() const { return nearest_.empty(); }

  /// sRGB, the mean of those that agree with the median of the nearest; black where there is none.
  std::array<std::uint8_t, 3> Color() const;

  std::uint8_t Nearness() const { return nearest_[0].rank; }

  /// Largest difference of lightness among the nearest: large where what was seen is not on the
  /// ground.
  std::uint8_t Disagreement() const;

 private:
  static constexpr std::size_t kNumObservations = 5;
  BestObservations<kNumObservations> nearest_;
};

}  // namespace parkade
