#include "mapping/evaluation/height_raster.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace parkade {
namespace {

constexpr double kMaxDeckDistance = 1.5;  // [m] in height from the path: only the deck driven on

using Corners = std::array<Eigen::Vector3d, 3>;

/// Heights of one triangle at the raster points inside it or on its edges.
void RasterizeTriangle(const Corners& corner, double spacing,
                       std::vector<HeightRaster::Sample>& samples) {
  const Eigen::Vector3d low = corner[0].cwiseMin(corner[1]).cwiseMin(corner[2]);
  const Eigen::Vector3d high = corner[0].cwiseMax(corner[1]).cwiseMax(corner[2]);
  const Eigen::Vector2d u = (corner[1] - corner[0]).head<2>(),
                        v = (corner[2] - corner[0]).head<2>();
  const double area = u.x() * v.y() - u.y() * v.x();
  if (std::abs(area) < 1e-12) return;
  constexpr double kOnEdge = -1e-9;
  const auto first = [&](double coordinate) {
    return static_cast<int>(std::ceil(coordinate / spacing - 0.5));
  };
  for (int y = first(low.y()); (y + 0.5) * spacing <= high.y(); ++y)
    for (int x = first(low.x()); (x + 0.5) * spacing <= high.x(); ++x) {
      const Eigen::Vector2d p = spacing * Eigen::Vector2d(x + 0.5, y + 0.5) - corner[0].head<2>();
      const double b = (p.x() * v.y() - p.y() * v.x()) / area;
      const double c = (u.x() * p.y() - u.y() * p.x()) / area;
      if (b < kOnEdge || c < kOnEdge || 1 - b - c < kOnEdge) continue;
      samples.push_back(
          {x, y, (1 - b - c) * corner[0].z() + b * corner[1].z() + c * corner[2].z()});
    }
}

/// Offsets of raster points within `radius`, nearest first.
std::vector<std::pair<int, int>> Disc(double radius, double spacing) {
  std::vector<std::pair<int, int>> offsets;
  const int reach = static_cast<int>(radius / spacing);
  for (int dy = -reach; dy <= reach; ++dy)
    for (int dx = -reach; dx <= reach; ++dx)
      if (std::hypot(dx, dy) * spacing <= radius) offsets.emplace_back(dx, dy);
  std::sort(offsets.begin(), offsets.end(), [](const auto& a, const auto& b) {
    const int near_a = a.first * a.first + a.second * a.second,
              near_b = b.first * b.first + b.second * b.second;
    return std::tie(near_a, a) < std::tie(near_b, b);
  });
  return offsets;
}

}  // namespace

HeightRaster::HeightRaster(const TriangleMesh& mesh, double spacing, double merge_gap)
    : spacing_(spacing) {
  std::vector<Sample> all;
  for (const auto& triangle : mesh.triangles) {
    Corners corners;
    for (size_t i = 0; i < 3; ++i)
      corners[i] = mesh.vertices[triangle[i]].cast<double>() + mesh.origin;
    RasterizeTriangle(corners, spacing, all);
  }
  std::sort(all.begin(), all.end(), [](const Sample& a, const Sample& b) {
    return std::tie(a.y, a.x, a.height) < std::tie(b.y, b.x, b.height);
  });
  for (size_t begin = 0, end; begin < all.size(); begin = end) {
    double sum = 0;
    for (end = begin; end < all.size() && all[end].x == all[begin].x &&
                      all[end].y == all[begin].y && all[end].height - all[begin].height < merge_gap;
         ++end)
      sum += all[end].height;
    samples_.push_back({all[begin].x, all[begin].y, sum / static_cast<double>(end - begin)});
  }
  for (size_t i = 0; i < samples_.size(); ++i)
    first_at_.try_emplace(KeyOf(samples_[i].x, samples_[i].y), static_cast<int>(i));
}

int HeightRaster::Find(int x, int y, double height, double max_gap) const {
  const auto first = first_at_.find(KeyOf(x, y));
  if (first == first_at_.end()) return -1;
  int nearest = -1;
  double nearest_gap = max_gap;
  for (auto i = static_cast<size_t>(first->second);
       i < samples_.size() && samples_[i].x == x && samples_[i].y == y; ++i) {
    const double gap = std::abs(samples_[i].height - height);
    if (gap <= nearest_gap) nearest = static_cast<int>(i), nearest_gap = gap;
  }
  return nearest;
}

std::optional<double> HeightRaster::DistanceTo(const Sample& place, double radius) const {
  std::optional<double> nearest;
  for (const auto& [dx, dy] : Disc(radius, spacing_)) {
    const double across = std::hypot(dx, dy) * spacing_;
    if (nearest && across >= *nearest) break;
    const int found = Find(place.x + dx, place.y + dy, place.height, radius);
    if (found < 0) continue;
    const double distance =
        std::hypot(across, samples_[static_cast<size_t>(found)].height - place.height);
    if (distance <= radius && (!nearest || distance < *nearest)) nearest = distance;
  }
  return nearest;
}

std::vector<bool> HeightRaster::GrowRings(const std::vector<size_t>& first_ring, int num_rings,
                                          double max_gap) const {
  std::vector<bool> is_reached(samples_.size());
  for (const size_t i : first_ring) is_reached[i] = true;
  const auto neighbors = Disc(1.5 * spacing_, spacing_);
  std::vector<size_t> ring = first_ring;
  for (int step = 0; step < num_rings; ++step) {
    std::vector<size_t> next;
    for (const size_t i : ring)
      for (const auto& [dx, dy] : neighbors) {
        const int found = Find(samples_[i].x + dx, samples_[i].y + dy, samples_[i].height, max_gap);
        if (found < 0 || is_reached[static_cast<size_t>(found)]) continue;
        is_reached[static_cast<size_t>(found)] = true;
        next.push_back(static_cast<size_t>(found));
      }
    ring = std::move(next);
  }
  return is_reached;
}

std::vector<bool> HeightRaster::FindRim(double width, double max_gap) const {
  // Rings of one raster step, from the outline inwards.
  const auto neighbors = Disc(1.5 * spacing_, spacing_);
  std::vector<size_t> outline;
  for (size_t i = 0; i < samples_.size(); ++i)
    if (std::any_of(neighbors.begin(), neighbors.end(), [&](const std::pair<int, int>& step) {
          return Find(samples_[i].x + step.first, samples_[i].y + step.second, samples_[i].height,
                      max_gap) < 0;
        }))
      outline.push_back(i);
  return GrowRings(outline, static_cast<int>(std::round(width / spacing_)) - 1, max_gap);
}

std::vector<bool> HeightRaster::Widen(const std::vector<bool>& is_marked, double width,
                                      double max_gap) const {
  std::vector<size_t> marked;
  for (size_t i = 0; i < is_marked.size(); ++i)
    if (is_marked[i]) marked.push_back(i);
  return GrowRings(marked, static_cast<int>(std::round(width / spacing_)), max_gap);
}

std::vector<bool> HeightRaster::FindNear(std::span<const Eigen::Vector3d> path,
                                         double radius) const {
  // Path points by squares of the radius: all that is near lies in the nine around.
  std::map<std::pair<int, int>, std::vector<Eigen::Vector3d>> squares;
  const auto square_of = [&](double x, double y) {
    return std::pair(static_cast<int>(std::floor(x / radius)),
                     static_cast<int>(std::floor(y / radius)));
  };
  for (const Eigen::Vector3d& point : path)
    squares[square_of(point.x(), point.y())].push_back(point);
  const auto is_near = [&](const Eigen::Vector3d& place) {
    const auto [sx, sy] = square_of(place.x(), place.y());
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const auto found = squares.find({sx + dx, sy + dy});
        if (found == squares.end()) continue;
        for (const Eigen::Vector3d& point : found->second)
          if ((point - place).head<2>().norm() <= radius &&
              std::abs(point.z() - place.z()) <= kMaxDeckDistance)
            return true;
      }
    return false;
  };
  std::vector<bool> result(samples_.size());
  for (size_t i = 0; i < samples_.size(); ++i) result[i] = is_near(PointOf(samples_[i]));
  return result;
}

}  // namespace parkade
