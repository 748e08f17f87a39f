#include "tests/simulator/ground/road_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/parallel.h"

namespace parkade::simulator {
namespace {

using Eigen::Vector2d;

double DistanceToLine(const Vector2d& point, const RoadField::Line& line) {
  double best = std::numeric_limits<double>::infinity();
  for (size_t i = 1; i < line.size(); ++i) {
    const Vector2d side = line[i] - line[i - 1];
    const double along =
        std::clamp((point - line[i - 1]).dot(side) / std::max(1e-12, side.squaredNorm()), 0.0, 1.0);
    best = std::min(best, (point - line[i - 1] - along * side).squaredNorm());
  }
  return std::sqrt(best);
}

/// The smaller of two, rounded where they are nearly the same.
double SmoothMin(double a, double b) {
  constexpr double kRounding = 6;  // [m]
  const double overlap = std::max(0.0, kRounding - std::abs(a - b)) / kRounding;
  return std::min(a, b) - overlap * overlap * kRounding / 4;
}

}  // namespace

RoadField::RoadField(const std::vector<Line>& streets, double half_width, double margin) {
  Vector2d max = streets[0][0];
  min_ = max;
  for (const Line& street : streets)
    for (const Vector2d& point : street) {
      min_ = min_.cwiseMin(point);
      max = max.cwiseMax(point);
    }
  min_.array() -= half_width + margin;
  columns_ = static_cast<int>((max.x() + half_width + margin - min_.x()) / kStep) + 1;
  rows_ = static_cast<int>((max.y() + half_width + margin - min_.y()) / kStep) + 1;
  values_.resize(static_cast<size_t>(columns_ * rows_));
  ParallelFor(static_cast<size_t>(rows_), [&](size_t row) {
    for (int column = 0; column < columns_; ++column) {
      const Vector2d point = Place(column, static_cast<int>(row));
      double distance = DistanceToLine(point, streets[0]);
      for (size_t i = 1; i < streets.size(); ++i)
        distance = SmoothMin(distance, DistanceToLine(point, streets[i]));
      values_[row * static_cast<size_t>(columns_) + static_cast<size_t>(column)] =
          static_cast<float>(distance - half_width);
    }
  });
}

double RoadField::At(const Vector2d& point) const {
  const Vector2d place = (point - min_) / kStep;
  const int column = static_cast<int>(std::floor(place.x())),
            row = static_cast<int>(std::floor(place.y()));
  if (column < 0 || row < 0 || column + 1 >= columns_ || row + 1 >= rows_) return 100;
  const double u = place.x() - column, v = place.y() - row;
  return (AtNode(column, row) * (1 - u) + AtNode(column + 1, row) * u) * (1 - v) +
         (AtNode(column, row + 1) * (1 - u) + AtNode(column + 1, row + 1) * u) * v;
}

Vector2d RoadField::Gradient(const Vector2d& point) const {
  const Vector2d x(kStep / 2, 0), y(0, kStep / 2);
  return Vector2d(At(point + x) - At(point - x), At(point + y) - At(point - y)) / kStep;
}

std::vector<std::pair<Vector2d, Vector2d>> RoadField::Kerbs() const {
  std::vector<std::pair<Vector2d, Vector2d>> kerbs;
  constexpr std::array<std::array<int, 2>, 4> kCorners = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  for (int row = 0; row + 1 < rows_; ++row) {
    for (int column = 0; column + 1 < columns_; ++column) {
      std::vector<Vector2d> crossings;
      for (size_t i = 0; i < 4; ++i) {
        const auto& [ax, ay] = kCorners[i];
        const auto& [bx, by] = kCorners[(i + 1) % 4];
        const double a = AtNode(column + ax, row + ay), b = AtNode(column + bx, row + by);
        if ((a < 0) == (b < 0)) continue;
        const double share = a / (a - b);
        crossings.push_back(Place(column + ax, row + ay) * (1 - share) +
                            Place(column + bx, row + by) * share);
      }
      if (crossings.size() != 2 || (crossings[1] - crossings[0]).norm() < 1e-3) continue;
      const Vector2d along = crossings[1] - crossings[0], right(along.y(), -along.x());
      const bool has_road_right = right.dot(Gradient((crossings[0] + crossings[1]) / 2)) < 0;
      kerbs.emplace_back(crossings[has_road_right ? 0 : 1], crossings[has_road_right ? 1 : 0]);
    }
  }
  return kerbs;
}

}  // namespace parkade::simulator
