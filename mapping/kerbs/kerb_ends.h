#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/ground_markings.h"

namespace parkade {

/// A place on a kerb.
struct KerbPlace {
  static constexpr double kSpacing = 0.25;   ///< [m] from one to the next
  static constexpr double kSameDeck = 1.0;   ///< [m] of height between those of one deck
  static constexpr double kParallel = 0.94;  ///< cosine of the angle between a kerb and its line

  Eigen::Vector3d foot;   ///< [m] in site
  Eigen::Vector2d along;  ///< unit; the ground lies on the left
  std::size_t kerb = 0;   ///< of which
  double weight = 1;      ///< of what it says of a line
};

/// Points every KerbPlace::kSpacing along a line of one point at least.
std::vector<Eigen::Vector3d> Spaced(const std::vector<Eigen::Vector3d>& line);

/// The places of a kerb of two points at least.
std::vector<KerbPlace> PlacesAlong(const Kerb& kerb, std::size_t index);

/// A straight line that kerbs lie on.
struct KerbAxis {
  Eigen::Vector3d middle;     ///< [m] in site
  Eigen::Vector2d direction;  ///< unit
  double slope = 0;           ///< of the ground along it

  double Along(const Eigen::Vector3d& place) const {  ///< [m] from the middle
    return (place - middle).head<2>().dot(direction);
  }
  Eigen::Vector3d At(double along) const {
    return middle + along * Eigen::Vector3d(direction.x(), direction.y(), slope);
  }
};

/// The line through places, least squares. \param toward  about its direction
KerbAxis FitAxis(std::span<const KerbPlace> places, const Eigen::Vector2d& toward);

/// How far [m] an offset leads beside a direction of length 1, to the right.
inline double Beside(const Eigen::Vector2d& offset, const Eigen::Vector2d& direction) {
  return offset.x() * direction.y() - offset.y() * direction.x();
}

/// One end of a kerb.
struct KerbEnd {
  Eigen::Vector3d foot = Eigen::Vector3d::Zero();     ///< [m] in site
  Eigen::Vector2d outward = Eigen::Vector2d::Zero();  ///< unit: where it points to, roughly
  Eigen::Vector3d start = Eigen::Vector3d::Zero();    ///< [m] where its line begins: before a hook
  std::optional<KerbAxis> line = {};                  ///< none where it bends; it leads outward
  std::vector<KerbPlace> on_line = {};  ///< what that goes by, of this kerb and of others
  double hook = 0;                      ///< [m] that is not on it, at the end
  double max_hidden = 14;  ///< [m] to follow it in one piece: two cars and what is between
};

/// The line on which most places around the end of a kerb lie, its own last 6 m and what else is
/// within 25 m: other kerbs on the same line say better than a short one where it leads.
/// O(own places times all places nearby squared). \param own  its places from that end on, one at
/// least \param sign  1 if the kerb leads to this end, else -1 \param all  the places of all kerbs
KerbEnd FindEnd(std::span<const KerbPlace> own, double sign, std::span<const KerbPlace> all);

/// The ways on from an end that has no line, for a kerb whose pieces lie along two directions at
/// right angles: straight on, and around the next corner of what it goes around. The likeliest
/// first. \param places  of the kerb \param left  1 where the ground lies on the left of the way
/// beyond that end, else -1
std::vector<KerbEnd> AroundCorners(const KerbEnd& end, std::span<const KerbPlace> places,
                                   double left);

}  // namespace parkade
