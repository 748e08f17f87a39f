#include "tests/mapping/worlds/synthetic_drive.h"

#include <Eigen/Geometry>
#include <cmath>
#include <deque>
#include <numbers>

#include "core/parallel.h"

namespace parkade {
namespace {

constexpr double kImuHeight = 0.6;  // [m] of the body where there is no vehicle.yaml
constexpr double kSpeed = 4;        // [m/s]

/// A camera at `position` that looks along `yaw`, tilted down.
Rigid3 LookAt(const Eigen::Vector3d& position, double yaw, double down) {
  const Eigen::Vector3d forward(std::cos(yaw) * std::cos(down), std::sin(yaw) * std::cos(down),
                                -std::sin(down));
  Eigen::Matrix3d axes;
  axes.col(2) = forward;
  axes.col(0) = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return {Eigen::Quaterniond(axes), position};
}

Eigen::Vector3d RayOf(const CameraModel& model, int x, int y) {
  return model.Unproject({x, y}).value_or(Eigen::Vector3d::Zero());
}

class SyntheticStream : public RecordStream {
 public:
  SyntheticStream(const SyntheticDrive& drive, ReadOptions options)
      : drive_(drive), options_(std::move(options)) {
    next_ = drive.span().begin;
  }

  std::optional<SensorRecord> Next() override {
    while (ready_.empty() && next_ <= drive_.span().end) {
      const int num_cameras = static_cast<int>(drive_.rig().cameras.size());
      for (int camera = 0; camera < num_cameras && options_.images; ++camera) {
        // Cameras are not synchronized.
        const Timestamp time = next_ + 0.011 * camera;
        if (time > drive_.span().end ||
            (options_.wants_image && !options_.wants_image(camera, time)))
          continue;
        auto [image, mask] = drive_.Render(camera, time);
        ready_.push_back(CameraFrame{time, camera, image});
        if (options_.semantics && drive_.has_masks())
          ready_.push_back(SemanticFrame{time, camera, mask});
      }
      next_ = next_ + 1 / drive_.rate();
    }
    if (ready_.empty()) return std::nullopt;
    SensorRecord record = std::move(ready_.front());
    ready_.pop_front();
    return record;
  }

 private:
  const SyntheticDrive& drive_;
  ReadOptions options_;
  Timestamp next_;
  std::deque<SensorRecord> ready_;
};

}  // namespace

Rig MakeTestRig(bool has_vehicle, int width, int height) {
  const double focal = 0.31 * width;
  const KannalaBrandtProjection lens{
      .fx = focal, .fy = focal, .cx = 0.5 * width, .cy = 0.5 * height, .k1 = -0.02, .k2 = 0.001};
  Rig rig;
  const double degree = std::numbers::pi / 180;
  const std::array<Rigid3, 4> ground_from_camera{
      LookAt({3.6, 0, 0.7}, 0, 20 * degree), LookAt({-0.9, 0, 0.9}, std::numbers::pi, 25 * degree),
      LookAt({1.9, 0.95, 1.0}, 90 * degree, 35 * degree),
      LookAt({1.9, -0.95, 1.0}, -90 * degree, 35 * degree)};
  const Rigid3 ground_from_body{Eigen::Quaterniond::Identity(),
                                {0, 0, has_vehicle ? 0 : kImuHeight}};
  for (size_t i = 0; i < 4; ++i) {
    RigCamera camera;
    camera.name = "cam" + std::to_string(i);
    camera.topic = "/" + camera.name;
    camera.model = CameraModel(lens, width, height);
    camera.body_from_camera = ground_from_body.Inverse() * ground_from_camera[i];
    rig.cameras.push_back(camera);
  }
  rig.imu.topic = "/imu";
  if (has_vehicle) {
    rig.vehicle.emplace();
    rig.vehicle->wheelbase = 2.7;
    rig.vehicle->track = 1.6;
  }
  return rig;
}

Trajectory DriveAlong(const SyntheticScene& scene, const Eigen::Vector3d& start, double yaw,
                      const std::vector<PathPiece>& pieces, const Rig& rig) {
  constexpr double kStep = 0.02;  // [s]
  constexpr double kWheelbase = 2.7;
  const Rigid3 ground_from_body{Eigen::Quaterniond::Identity(),
                                {0, 0, rig.vehicle ? 0 : kImuHeight}};
  std::vector<TrajectoryState> states;
  Eigen::Vector3d rear = start;
  double time = 100;
  for (const PathPiece& piece : pieces)
    for (double along = 0; along < std::max(piece.length, 1e-9);
         along += kStep * kSpeed, time += kStep) {
      rear.z() = scene.GroundHeight(rear.x(), rear.y(), rear.z()).value_or(rear.z());
      const double front_x = rear.x() + kWheelbase * std::cos(yaw),
                   front_y = rear.y() + kWheelbase * std::sin(yaw);
      const double climb =
          scene.GroundHeight(front_x, front_y, rear.z()).value_or(rear.z()) - rear.z();
      TrajectoryState& state = states.emplace_back();
      state.time = TimestampFromSeconds(time);
      const Rigid3 site_from_ground{
          Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
              Eigen::AngleAxisd(-std::atan2(climb, kWheelbase), Eigen::Vector3d::UnitY()),
          rear};
      state.world_from_body = site_from_ground * ground_from_body;
      if (piece.length <= 0) continue;
      rear.head<2>() += kStep * kSpeed * Eigen::Vector2d(std::cos(yaw), std::sin(yaw));
      yaw += kStep * kSpeed * piece.curvature;
    }
  return Trajectory(states);
}

SyntheticDrive::SyntheticDrive(SyntheticScene scene, Rig rig, Trajectory site_from_body,
                               bool has_masks, double rate)
    : scene_(std::move(scene)),
      rig_(std::move(rig)),
      trajectory_(std::move(site_from_body)),
      has_masks_(has_masks),
      rate_(rate) {
  for (const RigCamera& camera : rig_.cameras) {
    std::vector<Eigen::Vector3d>& rays = rays_.emplace_back();
    for (int y = 0; y < camera.model.height(); ++y)
      for (int x = 0; x < camera.model.width(); ++x) rays.push_back(RayOf(camera.model, x, y));
  }
}

std::unique_ptr<RecordStream> SyntheticDrive::Read(const ReadOptions& options) const {
  return std::make_unique<SyntheticStream>(*this, options);
}

std::pair<cv::Mat, cv::Mat> SyntheticDrive::Render(int camera, Timestamp time) const {
  const RigCamera& lens = rig_.cameras[static_cast<size_t>(camera)];
  const std::vector<Eigen::Vector3d>& rays = rays_[static_cast<size_t>(camera)];
  const Rigid3 site_from_camera = trajectory_.At(time).value() * lens.body_from_camera;
  const Eigen::Matrix3d rotation = site_from_camera.rotation.toRotationMatrix();
  cv::Mat image(lens.model.height(), lens.model.width(), CV_8UC3, cv::Scalar(0, 0, 0));
  cv::Mat mask(lens.model.height(), lens.model.width(), CV_8UC1, cv::Scalar(0));
  ParallelFor(static_cast<size_t>(image.rows), [&](size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < image.cols; ++x) {
      const Eigen::Vector3d& ray =
          rays[row * static_cast<size_t>(image.cols) + static_cast<size_t>(x)];
      if (ray.isZero()) continue;
      const SyntheticScene::Hit hit = scene_.Trace(site_from_camera.translation, rotation * ray);
      image.at<cv::Vec3b>(y, x) = {hit.color[0], hit.color[1], hit.color[2]};
      mask.at<uchar>(y, x) = hit.is_drivable ? 255 : 0;
    }
  });
  return {image, mask};
}

}  // namespace parkade
