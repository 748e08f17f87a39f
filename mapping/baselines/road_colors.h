#pragma once

#include <Eigen/Core>
#include <vector>

namespace parkade {

/// What a place on the road looks like: lightness, a, b (8-bit CIE Lab) and the local roughness of
/// lightness.
using Appearance = Eigen::Array4f;

/// A few clusters of road colors: lit, shaded, patched. Robust: small clusters of the seeds are
/// dropped.
class RoadColors {
 public:
  /// Deterministic k-means (seeded at quantiles of lightness); cost O(seeds).
  explicit RoadColors(const std::vector<Appearance>& seeds);

  /// In sigmas, to the nearest cluster.
  float DistanceTo(const Appearance& appearance) const;

  /// True for what may be paint on this road: not darker than it, and of its hue or much brighter.
  bool MayBePaint(const Appearance& appearance) const;

 private:
  struct Cluster {
    Appearance mean;
    Appearance inverse_sigma;
  };
  std::vector<Cluster> clusters_;
};

}  // namespace parkade
