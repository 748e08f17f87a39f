#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "core/triangle_mesh.h"

namespace parkade {

using Bgr = std::array<std::uint8_t, 3>;

/// A flat parallelogram: corner + a u + b v, a and b in [0, 1].
struct SceneQuad {
  Eigen::Vector3d corner{}, u{}, v{};  ///< [m] in site
  bool is_drivable = false;
  bool has_slots = false;  ///< white lines 12 cm wide: x every 2.5 m, and y = +-5.5 m
  Bgr color{90, 90, 90};
  int noise = 0;  ///< of lightness, fixed to the place
};

/// A handful of flat things whose every point, color and label is known exactly.
class SyntheticScene {
 public:
  void AddQuad(const SceneQuad& quad);
  /// An upright box that stands on z = `bottom`: a parked car.
  void AddBox(const Eigen::Vector3d& center_of_bottom, const Eigen::Vector3d& size,
              const Bgr& color);

  struct Hit {
    Bgr color{};
    bool is_drivable = false;
    double distance = std::numeric_limits<double>::max();
  };
  /// What a ray sees first; the sky where nothing.
  Hit Trace(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;

  /// Height [m] of the drivable quad at (x, y) nearest to z.
  std::optional<double> GroundHeight(double x, double y, double z) const;
  static Bgr ColorAt(const SceneQuad& quad, const Eigen::Vector3d& point);
  const std::vector<SceneQuad>& quads() const { return quads_; }

  /// The drivable ground as cells of 10 cm, without what boxes stand on.
  TriangleMesh DrivableMesh() const;

 private:
  struct Box {
    Eigen::Vector2d low, high;
    double bottom = 0;
  };
  std::vector<SceneQuad> quads_;
  std::vector<Eigen::Vector3d> normals_;
  std::vector<Box> boxes_;
};

/// A flat lot 48 m x 24 m around the x axis with slots on both sides, parked cars, a pale pavement
/// behind them and walls around.
SyntheticScene MakeLot();

/// A lower deck, a ramp of 12 % and an upper deck 3 m higher that reaches back over the lower one.
SyntheticScene MakeDecks();

}  // namespace parkade
