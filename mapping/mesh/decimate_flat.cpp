#include "mapping/mesh/decimate_flat.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <utility>

namespace parkade {
namespace {

using Colors = std::vector<std::array<std::uint8_t, 3>>;
using Triangle = std::array<std::uint32_t, 3>;

constexpr int kNumRounds = 8;
constexpr double kLeastGain = 0.03;  // of the vertices must go in a round, or it was the last
constexpr double kLeastShape =
    0.12;  // of a triangle: twice its area by the sum of squared edges, 0.5 of half a square

/// Twice the area of a triangle seen from above; positive: counter-clockwise.
double AreaFromAbove(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

class FlatDecimator {
 public:
  FlatDecimator(const Colors& colors, const std::vector<bool>& is_kept,
                const DecimateFlatOptions& options, HeightMesh& mesh)
      : colors_(colors),
        is_kept_(is_kept),
        options_(options),
        vertices_(mesh.vertices),
        triangles_(mesh.triangles),
        triangles_of_(mesh.vertices.size()) {
    for (std::uint32_t t = 0; t < triangles_.size(); ++t)
      for (const std::uint32_t vertex : triangles_[t]) triangles_of_[vertex].push_back(t);
  }

  void Run() {
    std::vector<std::uint32_t> left(vertices_.size());
    for (std::uint32_t v = 0; v < left.size(); ++v) left[v] = v;
    for (int round = 0; round < kNumRounds; ++round) {
      std::vector<bool> has_to_stay(vertices_.size());
      const auto goes = [&](std::uint32_t vertex) {
        return !has_to_stay[vertex] && Remove(vertex, has_to_stay);
      };
      const size_t before = left.size();
      std::erase_if(left, goes);
      if (static_cast<double>(before - left.size()) < kLeastGain * static_cast<double>(before))
        break;
    }
  }

  /// Where all that went is left out. -> which vertices are left
  std::vector<std::uint32_t> Compact() {
    std::erase_if(triangles_, [](const Triangle& triangle) { return triangle[0] == triangle[1]; });
    std::vector<std::uint32_t> left, number(vertices_.size());
    for (std::uint32_t v = 0; v < vertices_.size(); ++v) {
      if (triangles_of_[v].empty()) continue;
      number[v] = static_cast<std::uint32_t>(left.size());
      vertices_[left.size()] = vertices_[v];
      left.push_back(v);
    }
    vertices_.resize(left.size());
    for (Triangle& triangle : triangles_)
      for (std::uint32_t& vertex : triangle) vertex = number[vertex];
    return left;
  }

 private:
  /// The neighbors of a vertex inside the mesh, counter-clockwise; nothing at a border.
  bool FindRing(std::uint32_t vertex) {
    edges_.clear();
    for (const std::uint32_t t : triangles_of_[vertex]) {
      const Triangle& triangle = triangles_[t];
      const size_t at = triangle[0] == vertex ? 0 : triangle[1] == vertex ? 1 : 2;
      edges_.emplace_back(triangle[(at + 1) % 3], triangle[(at + 2) % 3]);
    }
    ring_.clear();
    if (edges_.empty()) return false;
    std::uint32_t next = edges_[0].first;
    for (size_t i = 0; i < edges_.size(); ++i) {
      const auto edge = std::find_if(edges_.begin(), edges_.end(),
                                     [&](const auto& each) { return each.first == next; });
      if (edge == edges_.end()) return false;
      ring_.push_back(next);
      next = edge->second;
    }
    return next == ring_[0];
  }

  bool IsFlatInto(std::uint32_t vertex, size_t target) const {
    const Eigen::Vector3d &gone = vertices_[vertex], &into = vertices_[ring_[target]];
    bool is_below = false;
    for (size_t i = 1; i + 1 < ring_.size(); ++i) {
      const Eigen::Vector3d& a = vertices_[ring_[(target + i) % ring_.size()]];
      const Eigen::Vector3d& b = vertices_[ring_[(target + i + 1) % ring_.size()]];
      const double area = AreaFromAbove(into, a, b);
      const double edges = (a - into).head<2>().squaredNorm() + (b - into).head<2>().squaredNorm() +
                           (b - a).head<2>().squaredNorm();
      if (!(area > kLeastShape * edges)) return false;
      const double of_a = AreaFromAbove(into, gone, b), of_b = AreaFromAbove(into, a, gone);
      const double of_into = area - of_a - of_b;
      if (of_a < 0 || of_b < 0 || of_into < 0) continue;
      const double height = (of_into * into.z() + of_a * a.z() + of_b * b.z()) / area;
      if (std::abs(height - gone.z()) > options_.max_error) return false;
      is_below = true;
    }
    return is_below;
  }

  /// What of its neighbors `vertex` may become: the nearest one that leaves the ground as it is.
  std::optional<size_t> FindTarget(std::uint32_t vertex) {
    if (is_kept_[vertex] || !FindRing(vertex)) return {};
    for (const std::uint32_t around : ring_)
      if (HasContrast(colors_[vertex], colors_[around], options_.color_contrast)) return {};
    const auto is_allowed = [&](std::uint32_t target) {
      return std::all_of(ring_.begin(), ring_.end(), [&](std::uint32_t around) {
        return (vertices_[around] - vertices_[target]).squaredNorm() <=
                   options_.max_edge * options_.max_edge &&
               !HasContrast(colors_[around], colors_[target], options_.color_contrast);
      });
    };
    std::optional<size_t> best;
    double least = 0;
    for (size_t i = 0; i < ring_.size(); ++i) {
      const double distance = (vertices_[ring_[i]] - vertices_[vertex]).squaredNorm();
      if (best && distance >= least) continue;
      if (!is_allowed(ring_[i]) || !IsFlatInto(vertex, i) || !IsLinked(ring_[i])) continue;
      best = i, least = distance;
    }
    return best;
  }

  /// Two neighbors of the vertex alone are neighbors of the target: else the mesh would be folded.
  bool IsLinked(std::uint32_t target) const {
    size_t count = 0;
    for (const std::uint32_t around : ring_) {
      if (around == target) continue;
      const std::vector<std::uint32_t>& near = triangles_of_[around];
      count += std::any_of(near.begin(), near.end(), [&](std::uint32_t t) {
        return std::find(triangles_[t].begin(), triangles_[t].end(), target) != triangles_[t].end();
      });
    }
    return count == 2;
  }

  bool Remove(std::uint32_t vertex, std::vector<bool>& has_to_stay) {
    const std::optional<size_t> target = FindTarget(vertex);
    if (!target) return false;
    const std::uint32_t into = ring_[*target];
    for (const std::uint32_t around : ring_) has_to_stay[around] = true;
    for (const std::uint32_t t : std::exchange(triangles_of_[vertex], {})) {
      Triangle& triangle = triangles_[t];
      if (std::find(triangle.begin(), triangle.end(), into) == triangle.end()) {
        std::replace(triangle.begin(), triangle.end(), vertex, into);
        triangles_of_[into].push_back(t);
        continue;
      }
      for (const std::uint32_t corner : triangle)
        if (corner != vertex) std::erase(triangles_of_[corner], t);
      triangle.fill(into);
    }
    return true;
  }

  const Colors& colors_;
  const std::vector<bool>& is_kept_;
  const DecimateFlatOptions& options_;
  std::vector<Eigen::Vector3d>& vertices_;
  std::vector<Triangle>& triangles_;
  std::vector<std::vector<std::uint32_t>> triangles_of_;  ///< triangles of each vertex
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges_;
  std::vector<std::uint32_t> ring_;
};

}  // namespace

bool HasContrast(const std::array<std::uint8_t, 3>& a, const std::array<std::uint8_t, 3>& b,
                 int contrast) {
  for (size_t c = 0; c < 3; ++c)
    if (std::abs(int{a[c]} - int{b[c]}) > contrast) return true;
  return false;
}

std::vector<std::uint32_t> DecimateFlat(const Colors& colors, const std::vector<bool>& is_kept,
                                        const DecimateFlatOptions& options, HeightMesh& mesh) {
  FlatDecimator decimator(colors, is_kept, options, mesh);
  decimator.Run();
  return decimator.Compact();
}

}  // namespace parkade
