#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace parkade {

/// Values by the squares that their places lie in, so that those around a place are found at once.
template <typename Value>
class SquareIndex {
 public:
  /// \param side  [m] of a square
  explicit SquareIndex(double side) : side_(side) {}

  void Add(const Eigen::Vector2d& place, Value value) {
    squares_[SquareOf(place)].push_back(std::move(value));
  }

  /// All values within `radius` [m] of a place, and some further away: by square, x before y, then
  /// as they were added.
  template <typename Visitor>
  void VisitAround(const Eigen::Vector2d& center, double radius, const Visitor& visit) {
    Visit(*this, center, radius, visit);
  }
  template <typename Visitor>
  void VisitAround(const Eigen::Vector2d& center, double radius, const Visitor& visit) const {
    Visit(*this, center, radius, visit);
  }

 private:
  using Square = std::pair<int, int>;

  Square SquareOf(const Eigen::Vector2d& place) const {
    constexpr double kFarthest = 1e9;  // squares: what lies beyond is not told apart
    const auto index = [&](double at) {
      return static_cast<int>(std::clamp(std::floor(at / side_), -kFarthest, kFarthest));
    };
    return {index(place.x()), index(place.y())};
  }

  template <typename Self, typename Visitor>
  static void Visit(Self& self, const Eigen::Vector2d& center, double radius,
                    const Visitor& visit) {
    const auto [low_x, low_y] = self.SquareOf(center.array() - radius);
    const auto [high_x, high_y] = self.SquareOf(center.array() + radius);
    for (int x = low_x; x <= high_x; ++x)
      for (int y = low_y; y <= high_y; ++y)
        if (const auto found = self.squares_.find({x, y}); found != self.squares_.end())
          for (auto& value : found->second) visit(value);
  }

  double side_;
  std::map<Square, std::vector<Value>> squares_;
};

}  // namespace parkade
