#pragma once

#include <functional>

#include "tests/simulator/common/random.h"
#include "tests/simulator/ground/ground_canvas.h"
#include "tests/simulator/ground/road_look.h"

namespace parkade::simulator {

inline const Color kWhitePaint = Rgb(0.58f, 0.57f, 0.53f), kYellowPaint = Rgb(0.55f, 0.38f, 0.06f);

/// Paints what grounds look like, with one stream of random numbers: surfaces, damage,
/// dirt and worn markings. Lengths in meters.
class GroundPainter {
 public:
  /// Scatters over [0, extent] of the plane.
  GroundPainter(const Eigen::Vector2d& extent, GroundCanvas& canvas, std::uint64_t seed);

  /// A place to put something; empty: anywhere.
  using Chooser = std::function<Eigen::Vector2d()>;

  /// Where `covers`, or everywhere; elsewhere flat gray.
  void Asphalt(const RoadLook& look, const std::function<bool(float x, float y)>& covers = {});
  void Concrete();  ///< sealed slabs of 6 m with joints
  /// Rough concrete with grooves raked by hand, for ramps; `along` [m] counts across the grooves.
  void Ribbed(const std::function<float(float x, float y)>& along);
  void Patches(
      int count,
      const Chooser& place = {});  ///< repairs: rectangles of younger asphalt with a sealed seam
  void Cracks(int count,
              const Chooser& place =
                  {});  ///< random walks of a dark line, thick or thin, sometimes forking
  /// Oil and rust at `oil_place()`, spills and tire dust at `place()`.
  void Stains(int count, const Chooser& oil_place, const Chooser& place = {});
  void Litter(int count,
              const Chooser& place =
                  {});  ///< gum, pebbles, leaves, cigarette ends; in drifts, not everywhere
  void Manhole(const Eigen::Vector2d& center);
  /// The grate of a drain, 0.5 x 0.3 m, its bars across `yaw`.
  void Drain(const Eigen::Vector2d& center, double yaw);
  /// A gutter 0.16 m wide under a grate, between rims of concrete.
  void Gutter(const Eigen::Vector2d& from, const Eigen::Vector2d& to);
  /// A fallen leaf of a tree, 4 to 12 cm.
  void Leaf(const Eigen::Vector2d& center);
  /// Snow nearly everywhere that `depth` is 1 or more, hardly any where it is 0 or less, ragged
  /// patches between.
  void Snow(const std::function<double(const Eigen::Vector2d&)>& depth);
  /// A worn line of paint.
  void Line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double width, float wear,
            const Color& color = kWhitePaint);
  /// A direction arrow 3 m long.
  void Arrow(const Eigen::Vector2d& center, double yaw);
  /// A number of strokes as of a stencil, `height` tall, read along `yaw`.
  void Number(int value, const Eigen::Vector2d& center, double yaw, double height);
  /// Rubber of many tires along a track, `width` wide.
  void TireTrack(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double width, float cover);
  /// The same along a circle.
  void TireCircle(const Eigen::Vector2d& center, double radius, double width, float cover);
  /// A worn circle of paint.
  void Circle(const Eigen::Vector2d& center, double radius, double width, float wear,
              const Color& color);

  Eigen::Vector2d Anywhere() {
    return {random_.Uniform(0, extent_.x()), random_.Uniform(0, extent_.y())};
  }
  Random& random() { return random_; }
  const GroundCanvas& canvas() const { return canvas_; }

 private:
  GroundCanvas::Touch Worn(float x, float y, float signed_distance, float wear,
                           const Color& color) const;
  void Crack(Eigen::Vector2d at, double heading, double length, double width, int forks);

  Eigen::Vector2d extent_;
  GroundCanvas& canvas_;
  Random random_;
  std::uint32_t seed_;
  float texel_;
};

}  // namespace parkade::simulator
