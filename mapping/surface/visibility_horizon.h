#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/ground_patch.h"
#include "core/rigid3.h"
#include "mapping/surface/free_clearance.h"

namespace parkade {

/// How far the ground is free on rays from a camera, on the plane on which its car stands: where
/// none is free for a quarter of a meter, something stands. Nearer than 0.8 m everything is open.
class FreeRays {
 public:
  /// \param max_range  [m] horizontally, beyond which nothing is looked for and everything is
  /// hidden
  /// \param clearance  borrowed
  FreeRays(const Rigid3& site_from_camera, const Rigid3& site_from_ground, double max_range,
           const FreeClearance& clearance);

  /// [m] in one of kNumRayDirections.
  float RangeAlong(int direction) const;
  /// Whether the ground is free as far as a point.
  bool Reach(const Eigen::Vector2d& point) const;

 private:
  Eigen::Vector2d eye_, slope_;
  double height_;  // [m] of the plane below the eye
  double max_range_;
  const FreeClearance* clearance_;
};

/// How far a camera sees the ground before something stands on it, by direction: what is behind
/// shows in an image as the side of a car or a hedge. How high that is nobody knows, so that it
/// hides whatever follows.
class VisibilityHorizon {
 public:
  /// Nothing stands anywhere.
  VisibilityHorizon() = default;

  /// What the ground says: FreeRays in all directions.
  explicit VisibilityHorizon(const FreeRays& rays);

  /// Hides what follows on anything that an image of the camera, which was at `eye` [m], shows to
  /// stand on the ground: what has left since, and what ends between directions.
  void HideBehind(const PosedGroundPatch& seen, const Eigen::Vector2d& eye);

  /// Whether the camera, which is at `eye` [m], sees the ground at a point.
  bool Shows(const Eigen::Vector2d& eye, const Eigen::Vector2d& point) const;

 private:
  std::vector<float> ranges_;  ///< [m] by direction, evenly from -pi on; empty: open everywhere
};

}  // namespace parkade
