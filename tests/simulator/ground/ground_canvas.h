#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "tests/simulator/common/color.h"

namespace parkade::simulator {

/// The color of the ground over a rectangle of the world plane, as one image
/// seen from above with all its averaged levels. Colors are reflectances, kept
/// as 8-bit square roots so that dark asphalt has fine steps, and what is a marking.
class GroundCanvas {
 public:
  /// Covers [min, max] [m] of the world plane; black at first.
  GroundCanvas(const Eigen::Vector2d& min, const Eigen::Vector2d& max, double texel_size);

  double texel_size() const { return texel_size_; }  ///< [m]
  Eigen::Vector2d min() const { return min_.cast<double>(); }
  Eigen::Vector2d max() const;  ///< a part of a texel beyond what was asked for

  /// Sets every texel to `color(x, y)` of its center, in parallel.
  void Fill(const std::function<Color(float x, float y)>& color);

  /// What a brush does at a point: mixes in `color` by `cover` 0..1.
  struct Touch {
    Color color;
    float cover = 0;
    bool is_marking = false;     ///< where it covers half
    bool hides_marking = false;  ///< the same
  };
  /// Visits the texels of a box [m] around `center`, large boxes on all cores.
  void Paint(const Eigen::Vector2d& center, double reach,
             const std::function<Touch(float x, float y)>& brush);

  /// Makes the averaged levels; call once, after the last stroke.
  void Finish();

  /// Mean reflectance over about `footprint` [m] around a point, trilinear;
  /// points outside take the nearest texel's color. Thread-safe.
  Color Sample(float x, float y, float footprint) const;

  /// Whether the texel at a point belongs to a marking. Thread-safe.
  bool IsMarking(float x, float y) const;

 private:
  struct Level {
    int width = 0, height = 0;
    std::vector<std::uint32_t> texels;
  };
  Color SampleLevel(const Level& level, float column, float row) const;

  Eigen::Vector2f min_;
  float texel_size_;
  std::vector<Level> levels_;
};

}  // namespace parkade::simulator
