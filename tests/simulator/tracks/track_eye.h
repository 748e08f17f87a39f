#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/rig.h"
#include "core/timestamp.h"
#include "tests/simulator/motion/motion.h"

namespace parkade::simulator {

/// A half line of sight. World frame.
struct SightLine {
  Eigen::Vector3d origin;     ///< [m]
  Eigen::Vector3d direction;  ///< unit
};

/// The true geometry of the images that one camera takes on a drive: lens,
/// mounting, rolling shutter and motion, as the renderer has them. `motion` and
/// `camera` must outlive it.
class TrackEye {
 public:
  TrackEye(const Motion& motion, Timestamp epoch, const RigCamera& camera)
      : motion_(motion), epoch_(epoch), camera_(&camera) {}

  /// From now on the camera is mounted as this one, which must outlive the eye.
  void MountAs(const RigCamera& camera) { camera_ = &camera; }

  /// Where the image whose middle row is exposed at `time` shows a point of the
  /// world [m]; nothing outside the lens' domain. May lie outside the image.
  std::optional<Eigen::Vector2d> Project(const Eigen::Vector3d& point_in_world,
                                         Timestamp time) const;

  /// What a pixel of that image looks along; nothing outside the lens' domain.
  std::optional<SightLine> LineOf(const Eigen::Vector2d& pixel, Timestamp time) const;

  /// `world_from_camera` while `row` is exposed.
  Rigid3 WorldFromCamera(Timestamp time, double row) const;
  Rigid3 WorldFromCamera(Timestamp time) const { return WorldFromCamera(time, MiddleRow()); }

  Rigid3 WorldFromBody(Timestamp time) const { return motion_.WorldFromBody(SecondsOf(time)); }
  double SecondsOf(Timestamp time) const {
    return time - epoch_;
  }  ///< since the start of the drive

  const RigCamera& camera() const { return *camera_; }

 private:
  double MiddleRow() const { return (camera_->model.height() - 1) / 2.0; }

  const Motion& motion_;
  Timestamp epoch_;
  const RigCamera* camera_;
};

}  // namespace parkade::simulator
