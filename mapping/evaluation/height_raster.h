#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/triangle_mesh.h"

namespace parkade {

/// A mesh sampled at the points of a horizontal raster: at (x, y) there may be several heights. The
/// points are the centers of squares, so that what is made of such squares (a true surface) is
/// sampled inside them and its outline is not moved.
class HeightRaster {
 public:
  struct Sample {
    int x = 0, y = 0;   ///< index; the point is at (index + 0.5) * spacing
    double height = 0;  ///< [m]
  };

  /// Heights less than `merge_gap` [m] above each other at one point are one (their mean): the
  /// seams of overlapping triangles.
  HeightRaster(const TriangleMesh& mesh, double spacing, double merge_gap);

  /// Sorted by (y, x, height).
  const std::vector<Sample>& samples() const { return samples_; }

  /// Index of the sample at (x, y) nearest to `height`, at most `max_gap` away; or -1.
  int Find(int x, int y, double height, double max_gap) const;

  /// Distance [m] from a sample's place to the nearest sample within `radius` [m], or nothing.
  std::optional<double> DistanceTo(const Sample& place, double radius) const;

  /// For each sample: true when a raster point within `width` [m] has no sample of this deck: the
  /// rim.
  std::vector<bool> FindRim(double width, double max_gap) const;

  /// For each sample: true when one of those marked lies within `width` [m] on its deck, or itself
  /// is marked.
  std::vector<bool> Widen(const std::vector<bool>& is_marked, double width, double max_gap) const;

  /// For each sample: true with a point of `path` within `radius` [m] horizontally and 1.5 m in
  /// height.
  std::vector<bool> FindNear(std::span<const Eigen::Vector3d> path, double radius) const;

  /// [m] where a sample is.
  Eigen::Vector3d PointOf(const Sample& sample) const {
    return {(sample.x + 0.5) * spacing_, (sample.y + 0.5) * spacing_, sample.height};
  }

 private:
  std::vector<bool> GrowRings(const std::vector<size_t>& first_ring, int num_rings,
                              double max_gap) const;
  static std::uint64_t KeyOf(int x, int y) {
    return (std::uint64_t{static_cast<std::uint32_t>(x)} << 32) | static_cast<std::uint32_t>(y);
  }

  double spacing_;
  std::vector<Sample> samples_;
  std::unordered_map<std::uint64_t, int> first_at_;
};

}  // namespace parkade
