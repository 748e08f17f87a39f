#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace parkade::simulator {

/// One sheet of ground, as a deck or a ramp: a smooth height over a part of the plane.
struct GroundSheet {
  Eigen::Vector2d min = Eigen::Vector2d::Zero(),
                  max = Eigen::Vector2d::Zero();  ///< [m] box around the part
  /// [m]; C2-smooth, and defined a little beyond the part.
  std::function<double(const Eigen::Vector2d&)> height;
  /// Whether the part has this point; empty: all of the box.
  std::function<bool(const Eigen::Vector2d&)> covers;

  bool Covers(const Eigen::Vector2d& point) const {
    return (point.array() >= min.array()).all() && (point.array() <= max.array()).all() &&
           (!covers || covers(point));
  }
};

/// Height of the ground, on one level or on several above each other: sheets that
/// agree where they meet. A place is asked for with a hint `near_z` [m] of the height
/// that is meant; the nearest sheet there answers. World: z up, meters. Thread-safe.
class Ground {
 public:
  Ground() = default;
  /// At least one sheet.
  explicit Ground(std::vector<GroundSheet> sheets);

  /// The height of the sheet that SheetAt names.
  double Height(const Eigen::Vector2d& xy, double near_z) const;
  Eigen::Vector2d Gradient(const Eigen::Vector2d& xy, double near_z) const;
  Eigen::Vector3d Normal(const Eigen::Vector2d& xy, double near_z) const;  ///< unit, pointing up

  /// The sheet that covers the point and is nearest to `near_z`; where none covers
  /// it, the nearest of all.
  size_t SheetAt(const Eigen::Vector2d& xy, double near_z) const;
  const std::vector<GroundSheet>& sheets() const { return sheets_; }

 private:
  std::vector<GroundSheet> sheets_;
};

}  // namespace parkade::simulator
