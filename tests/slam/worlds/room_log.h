#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/drive_log.h"
#include "core/trajectory.h"
#include "tests/slam/worlds/rendered_room.h"

namespace parkade {

/// A car that looks to its left while it drives through a long room: one image per keyframe.
class RoomLog final : public DriveLog {
 public:
  static constexpr double kStep = 0.5;  ///< [m] and [s]

  /// After so many images the car is back where it began.
  /// \param scale  of the images
  explicit RoomLog(int num_images, int images_per_lap = std::numeric_limits<int>::max(),
                   double scale = 0.5)
      : num_images_(num_images),
        images_per_lap_(images_per_lap),
        camera_(SurroundFisheye().Scaled(scale), room_) {
    RigCamera& camera = rig_.cameras.emplace_back();
    camera.name = name_;
    camera.model = SurroundFisheye().Scaled(scale);
    const Eigen::Matrix3d body_from_camera =
        (Eigen::Matrix3d() << 1, 0, 0, 0, 0, 1, 0, -1, 0).finished();  // looks along y, upright
    camera.body_from_camera = {Eigen::Quaterniond(body_from_camera), {0, 0, 1}};
    rig_.vehicle.emplace();
  }

  const std::string& name() const override { return name_; }
  const Rig& rig() const override { return rig_; }
  TimeSpan span() const override { return {TimeOfImage(0), TimeOfImage(num_images_ - 1)}; }
  std::unique_ptr<RecordStream> Read(const ReadOptions&) const override {
    return std::make_unique<Stream>(*this);
  }

  Trajectory Truth() const {
    std::vector<TrajectoryState> states;
    for (int i = 0; i < num_images_; ++i) {
      TrajectoryState& state = states.emplace_back();
      state.time = TimeOfImage(i);
      state.world_from_body.translation = PlaceOf(i);
    }
    return Trajectory(std::move(states));
  }
  /// That the last pass has delivered.
  int num_read() const { return num_read_; }

 private:
  class Stream final : public RecordStream {
   public:
    explicit Stream(const RoomLog& log) : log_(log) { log_.num_read_ = 0; }
    std::optional<SensorRecord> Next() override {
      if (log_.num_read_ == log_.num_images_) return std::nullopt;
      const int i = log_.num_read_++;
      Rigid3 room_from_body;
      room_from_body.translation = log_.PlaceOf(i);
      const Rigid3 room_from_camera = room_from_body * log_.rig_.cameras[0].body_from_camera;
      return CameraFrame{log_.TimeOfImage(i), 0, log_.camera_.Render(room_from_camera, 1.0, i)};
    }

   private:
    const RoomLog& log_;
  };

  Timestamp TimeOfImage(int i) const { return Timestamp{1'000'000'000} + kStep * i; }

  Eigen::Vector3d PlaceOf(int i) const { return {kStep * (i % images_per_lap_), 0, 0}; }

  int num_images_, images_per_lap_;
  std::string name_ = "cam0";
  Rig rig_;
  RenderedRoom room_{{-5, -2, 0}, {60, 4, 3}, 3};
  RoomCamera camera_;
  mutable int num_read_ = 0;
};

}  // namespace parkade
