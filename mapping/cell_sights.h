#pragma once

#include <array>
#include <cstdint>

namespace parkade {

/// What a cell of the ground looks like: the nearest sights of it. The latest drive that saw it well decides alone,
/// since days differ in light: sights step back, as if they were several times less near, when a later drive comes.
class CellSights {
 public:
  struct Sight {
    std::uint8_t blue = 0, green = 0, red = 0;
    std::uint8_t nearness = 0;  ///< 1 to 255; 0: none
  };

  /// \param is_first  of its drive in this cell; drives come one after the other, the latest last
  void Add(const Sight& sight, bool is_first);

  bool empty() const { return sights_[0].nearness == 0; }

  /// sRGB, the mean of those that agree with the median of the nearest; black where there is none.
  std::array<std::uint8_t, 3> Color() const;

 private:
  std::array<Sight, 5> sights_{};  ///< nearest first
};

}  // namespace parkade
