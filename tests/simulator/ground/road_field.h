#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace parkade::simulator {

/// How far a point of the plane is from the kerb of a network of streets, negative on the road.
/// Streets that meet are joined by rounded kerbs. Kept as a grid of half-meter steps.
class RoadField {
 public:
  using Line = std::vector<Eigen::Vector2d>;
  static constexpr double kStep = 0.5;  ///< [m]

  RoadField() = default;
  /// Streets of 2 * `half_width` [m] along polylines, and `margin` [m] of land around them.
  RoadField(const std::vector<Line>& streets, double half_width, double margin);

  /// [m], bilinear; far away for points outside the grid.
  double At(const Eigen::Vector2d& point) const;
  Eigen::Vector2d Gradient(const Eigen::Vector2d& point) const;

  /// Stretches of kerb, the road on the right of first -> second.
  std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> Kerbs() const;

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  Eigen::Vector2d Place(int column, int row) const {
    return min_ + kStep * Eigen::Vector2d(column, row);
  }
  double AtNode(int column, int row) const {
    return values_[static_cast<size_t>(row * columns_ + column)];
  }
  const Eigen::Vector2d& min() const { return min_; }
  Eigen::Vector2d max() const { return Place(columns_ - 1, rows_ - 1); }

 private:
  Eigen::Vector2d min_ = Eigen::Vector2d::Zero();
  int columns_ = 0, rows_ = 0;
  std::vector<float> values_;
};

}  // namespace parkade::simulator
