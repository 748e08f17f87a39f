#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "core/rig.h"
#include "tests/simulator/rays/ray_scene.h"
#include "tests/simulator/scenes/mover_scene.h"
#include "tests/simulator/scenes/scene.h"

namespace parkade::simulator {

/// Where a ray of light comes from. World frame.
struct Sight {
  Eigen::Vector3d point;   ///< [m]
  Eigen::Vector3d normal;  ///< unit, toward the eye
  double distance = 0;     ///< [m] along the ray
  bool is_ground = false;
  const Mover* mover = nullptr;  ///< that it is on; null: it stands still
};

/// The surfaces of a scene without their looks: what can be seen from where.
/// `scene` must outlive it. One image at a time.
class TrackWorld {
 public:
  explicit TrackWorld(const Scene& scene);

  /// Moves what moves to where it is at `time` [s of the drive], as far as it can be seen from
  /// `eye`.
  void PlaceMovers(double time, const Eigen::Vector3d& eye) {
    movers_.PlaceAt(time, time + kInstant, eye);
  }

  /// The first surface that a ray meets within `kSight`; nothing: the sky.
  /// `direction` is unit.
  std::optional<Sight> Look(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;

  /// True where a surface stands between `eye` and `point`, more than 5 cm and 1 % of the way
  /// before it.
  bool IsHidden(const Eigen::Vector3d& eye, const Eigen::Vector3d& point) const;

  /// True where the own car stands in the way of a ray in body.
  bool OwnCarHides(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;

  const Eigen::Vector3d& to_sun() const { return to_sun_; }  ///< unit, in world

  /// CV_8UC1 of the image's size, 0 where a pixel shows the own car or lies beyond
  /// the lens' angle of view; borders as in SampleTable::Mask, to two pixels.
  cv::Mat OwnCarMask(const RigCamera& camera, double half_field_of_view) const;

  static constexpr double kSight = 400;  ///< [m]

 private:
  static constexpr double kInstant = 1e-3;  ///< [s]

  RayScene world_, own_car_;
  MoverScene movers_;
  Eigen::Vector3d to_sun_;
};

}  // namespace parkade::simulator
