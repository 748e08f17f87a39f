#include "tests/simulator/tracks/track_eye.h"

#include <cmath>

namespace parkade::simulator {

Rigid3 TrackEye::WorldFromCamera(Timestamp time, double row) const {
  return motion_.WorldFromBody(time - epoch_ + camera_->line_delay * (row - MiddleRow())) *
         camera_->body_from_camera;
}

std::optional<Eigen::Vector2d> TrackEye::Project(const Eigen::Vector3d& point_in_world,
                                                 Timestamp time) const {
  std::optional<Eigen::Vector2d> pixel =
      camera_->model.Project(WorldFromCamera(time).Inverse() * point_in_world);
  if (camera_->line_delay == 0) return pixel;
  // The row decides the moment, the moment decides the row: a contraction while nothing crosses the
  // image in one frame.
  constexpr int kMaxIterations = 8;
  constexpr double kConverged = 1e-6;  // [px]
  for (int i = 0; pixel && i < kMaxIterations; ++i) {
    const double row = pixel->y();
    if (!(std::abs(row) < 4 * camera_->model.height())) return std::nullopt;
    pixel = camera_->model.Project(WorldFromCamera(time, row).Inverse() * point_in_world);
    if (pixel && std::abs(pixel->y() - row) < kConverged) break;
  }
  return pixel;
}

std::optional<SightLine> TrackEye::LineOf(const Eigen::Vector2d& pixel, Timestamp time) const {
  const std::optional<Eigen::Vector3d> bearing = camera_->model.Unproject(pixel);
  if (!bearing) return std::nullopt;
  const Rigid3 world_from_camera = WorldFromCamera(time, pixel.y());
  return SightLine{world_from_camera.translation, world_from_camera.rotation * *bearing};
}

}  // namespace parkade::simulator
