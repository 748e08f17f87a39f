#pragma once

#include <Eigen/Core>
#include <cmath>
#include <set>
#include <utility>

namespace parkade {

/// Some squares of the ground, whatever the deck, by their place in a grid through the origin.
class GroundSquares {
 public:
  explicit GroundSquares(double side) : side_(side) {}

  void Add(const Eigen::Vector3d& point) { squares_.insert(SquareOf(point)); }
  bool Has(const Eigen::Vector3d& point) const { return squares_.contains(SquareOf(point)); }
  bool empty() const { return squares_.empty(); }

 private:
  std::pair<int, int> SquareOf(const Eigen::Vector3d& point) const {
    return {static_cast<int>(std::floor(point.x() / side_)),
            static_cast<int>(std::floor(point.y() / side_))};
  }

  double side_;  ///< [m]
  std::set<std::pair<int, int>> squares_;
};

}  // namespace parkade
