#include "tests/support/sampled_drive.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "tests/support/fisheye_camera.h"

namespace parkade {
namespace {

constexpr double kBeginOfTime = 1000;            // [s]
constexpr double kMaxAngle = 92.5 * M_PI / 180;  // half the field of view
constexpr double kMinRange = 0.8;                // [m] at which points are seen
constexpr double kTrackLoss = 0.03;              // per image
constexpr double kWander = 3e-3;                 // [rad] per image, of an outlier
constexpr int kWidth = 640, kHeight = 480;       // [px] of images that nobody draws
const Eigen::Vector3d kGravity(0, 0, -9.81);

using Random = std::mt19937;

Eigen::Vector3d Gaussian3(Random& random, double sigma) {
  std::normal_distribution<double> normal(0, sigma);
  const double x = normal(random), y = normal(random), z = normal(random);
  return {x, y, z};
}

Timestamp TimeAt(double seconds) { return TimestampFromSeconds(kBeginOfTime + seconds); }

/// A camera that looks along `yaw_deg` to the left of forward, and down.
RigCamera MakeCamera(const std::string& name, const Eigen::Vector3d& position, double yaw_deg,
                     double down_deg) {
  return MakeFisheyeCamera(name, position, yaw_deg * M_PI / 180, down_deg * M_PI / 180, 140, kWidth,
                           kHeight);
}

Rig CarRig(int num_cameras) {
  Rig rig;
  rig.cameras = {MakeCamera("front", {3.7, 0, 0.6}, 0, 15), MakeCamera("left", {2, 1, 1}, 90, 20),
                 MakeCamera("right", {2, -1, 1}, -90, 20),
                 MakeCamera("rear", {-0.9, 0, 0.9}, 180, 15)};
  rig.cameras.resize(static_cast<size_t>(num_cameras));
  rig.body_from_imu = {
      Eigen::Quaterniond(Eigen::AngleAxisd(0.05, Eigen::Vector3d(0.2, 0.9, 0.4).normalized())),
      {1.2, 0.1, 0.5}};
  rig.vehicle = VehicleCalibration{};
  return rig;
}

std::vector<Eigen::Vector3d> PointsAlongPath(const MotionFunction& motion,
                                             const SampledDriveOptions& options, Random& random) {
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Eigen::Vector3d> points;
  double due = 0;
  Eigen::Vector3d last = motion(options.start).world_from_body.translation;
  const auto scatter = [&](const Rigid3& world_from_body) {
    const double side = uniform(random) < 0.5 ? -1 : 1;
    const bool is_ground = uniform(random) < 0.3;
    const double lateral = is_ground ? 1.2 + 5 * uniform(random) : 3 + 12 * uniform(random);
    const double height = is_ground ? 0 : 4 * uniform(random);
    points.push_back(world_from_body *
                     Eigen::Vector3d(8 * uniform(random) - 4, side * lateral, height));
  };
  // A hall around the start, then walls along the way and beyond its ends.
  for (int i = 0; i < 150; ++i) {
    Rigid3 spread = motion(options.start).world_from_body;
    spread.translation += spread.rotation * Eigen::Vector3d(50 * uniform(random) - 25, 0, 0);
    scatter(spread);
  }
  for (double t = options.start; t < options.start + options.duration; t += 0.02) {
    const Rigid3 pose = motion(t).world_from_body;
    due += (pose.translation - last).norm() * options.points_per_meter;
    last = pose.translation;
    for (; due > 1; --due) scatter(pose);
  }
  for (int i = 0; i < 150; ++i) {
    Rigid3 spread = motion(options.start + options.duration).world_from_body;
    spread.translation += spread.rotation * Eigen::Vector3d(50 * uniform(random) - 25, 0, 0);
    scatter(spread);
  }
  return points;
}

std::vector<Eigen::Vector3d> PointsInRoom(const SampledDriveOptions& options, Random& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 50 * options.points_per_meter; ++i) {
    Eigen::Vector3d point(4 * uniform(random), 4 * uniform(random), 2 * uniform(random));
    int axis = i % 3;  // on a wall
    point[axis] = (axis == 2 ? 2.0 : 4.0) * (uniform(random) < 0 ? -1 : 1);
    points.push_back(point);
  }
  return points;
}

/// What cameras see of the world.
struct View {
  double max_angle = kMaxAngle;  ///< [rad] off the axis
  double max_range = 25;         ///< [m]
  bool shares_tracks = false;    ///< the same points have the same track numbers in all cameras
};

class TrackMaker {
 public:
  TrackMaker(const Rig& rig, int camera, const std::vector<Eigen::Vector3d>& points,
             const SampledDriveOptions& options, const View& view)
      : camera_(camera),
        body_from_camera_(rig.cameras[static_cast<size_t>(camera)].body_from_camera),
        model_(rig.cameras[static_cast<size_t>(camera)].model),
        points_(points),
        options_(options),
        view_(view),
        random_(options.seed * 977 + static_cast<std::uint32_t>(camera)) {}

  /// The image taken at `t` [s] into `motion`, stamped `time`.
  TrackedFrame Make(Timestamp time, const MotionFunction& motion, double t) {
    const Rigid3 camera_from_world = (motion(t).world_from_body * body_from_camera_).Inverse();
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<size_t> visible;
    for (size_t i = 0; i < points_.size(); ++i) {
      const Eigen::Vector3d in_camera = camera_from_world * points_[i];
      const double range = in_camera.norm();
      if (range < view_.max_range && range > kMinRange &&
          std::acos(in_camera.z() / range) < view_.max_angle)
        visible.push_back(i);
    }
    const std::set<size_t> visible_set(visible.begin(), visible.end());
    std::erase_if(tracks_, [&](const auto& entry) {
      return !visible_set.count(entry.first) || uniform(random_) < kTrackLoss;
    });
    std::shuffle(visible.begin(), visible.end(), random_);
    for (const size_t point : visible) {
      if (static_cast<int>(tracks_.size()) >= options_.tracks) break;
      if (!tracks_.count(point))
        tracks_[point] = {view_.shares_tracks ? static_cast<std::int64_t>(point)
                                              : (std::int64_t{camera_} << 40) + next_++,
                          uniform(random_) < options_.outliers, Eigen::Vector3d::Zero()};
    }
    TrackedFrame frame{time, camera_, {}};
    for (auto& [point, track] : tracks_) {
      if (track.wanders) track.offset += Gaussian3(random_, kWander);
      Eigen::Vector3d in_camera = camera_from_world * points_[point];
      if (options_.line_delay != 0) {
        const double row = PixelOf(in_camera).y() - 0.5 * (kHeight - 1);
        const Rigid3 then =
            motion(t + row * options_.line_delay).world_from_body * body_from_camera_;
        in_camera = then.Inverse() * points_[point];
      }
      const Eigen::Vector3d bearing =
          (in_camera.normalized() + track.offset + Gaussian3(random_, options_.bearing_sigma))
              .normalized();
      frame.observations.push_back(
          {track.number, PixelOf(bearing), bearing, options_.bearing_sigma});
    }
    return frame;
  }

  /// The mount turns.
  void Turn(const Eigen::Quaterniond& camera_from_camera) {
    body_from_camera_.rotation = body_from_camera_.rotation * camera_from_camera;
  }
  const Rigid3& body_from_camera() const { return body_from_camera_; }

 private:
  Eigen::Vector2d PixelOf(const Eigen::Vector3d& in_camera) const {
    return model_.Project(in_camera).value_or(Eigen::Vector2d::Zero());
  }

  struct Track {
    std::int64_t number;
    bool wanders;
    Eigen::Vector3d offset;
  };

  int camera_;
  Rigid3 body_from_camera_;
  CameraModel model_;
  const std::vector<Eigen::Vector3d>& points_;
  const SampledDriveOptions& options_;
  View view_;
  Random random_;
  std::map<size_t, Track> tracks_;
  std::int64_t next_ = 0;
};

void MakeImu(SampledDrive& drive, const MotionFunction& motion, const SampledDriveOptions& options,
             Random& random) {
  const ImuCalibration& imu = drive.rig.imu;
  const double root_rate = std::sqrt(options.imu_rate);
  const Rigid3 imu_from_body = drive.rig.body_from_imu.Inverse();
  const Eigen::Vector3d lever = drive.rig.body_from_imu.translation;
  Eigen::Vector3d gyroscope_bias = Gaussian3(random, options.gyroscope_bias);
  Eigen::Vector3d accelerometer_bias = Gaussian3(random, options.accelerometer_bias);
  for (int k = 0; k <= options.duration * options.imu_rate; ++k) {
    const double t = k / options.imu_rate;
    const BodyMotion at = motion(options.start + t);
    const Eigen::Vector3d& rate = at.angular_velocity;
    const Eigen::Vector3d acceleration =
        at.acceleration + at.world_from_body.rotation * (at.angular_acceleration.cross(lever) +
                                                         rate.cross(rate.cross(lever)));
    drive.imu.push_back(
        {TimeAt(t),
         imu_from_body.rotation * rate + gyroscope_bias +
             Gaussian3(random, options.noise * imu.gyroscope_noise_density * root_rate),
         imu_from_body.rotation *
                 (at.world_from_body.rotation.conjugate() * (acceleration - kGravity)) +
             accelerometer_bias +
             Gaussian3(random, options.noise * imu.accelerometer_noise_density * root_rate)});
    gyroscope_bias += Gaussian3(random, options.noise * imu.gyroscope_random_walk / root_rate);
    accelerometer_bias +=
        Gaussian3(random, options.noise * imu.accelerometer_random_walk / root_rate);
  }
}

void MakeFrames(SampledDrive& drive, const MotionFunction& motion,
                const std::vector<Eigen::Vector3d>& points, const SampledDriveOptions& options,
                const View& view) {
  for (size_t camera = 0; camera < drive.rig.cameras.size(); ++camera) {
    TrackMaker tracks(drive.true_rig, static_cast<int>(camera), points, options, view);
    Random random(options.seed * 31 + static_cast<std::uint32_t>(camera));
    const Eigen::Vector3d axis = Gaussian3(random, 1).normalized();
    const double offset = 0.0127 * static_cast<double>(camera);
    const double early = camera % 2 == 0 ? options.time_offset : -options.time_offset;
    bool has_jumped = static_cast<int>(camera) != options.jump_camera;
    for (int k = 0; offset + k / options.camera_rate <= options.duration; ++k) {
      const double t = offset + k / options.camera_rate;
      if (!has_jumped && t >= options.jump_time) {
        tracks.Turn(Eigen::Quaterniond(Eigen::AngleAxisd(options.jump_deg * M_PI / 180, axis)));
        drive.true_rig.cameras[camera].body_from_camera = tracks.body_from_camera();
        has_jumped = true;
      }
      drive.frames.push_back(tracks.Make(TimeAt(t - early), motion, options.start + t));
    }
  }
}

/// Makes drive.rig out of drive.true_rig.
void DisturbRig(SampledDrive& drive, const SampledDriveOptions& options) {
  Random random(options.seed * 7919);
  for (size_t i = 0; i < drive.rig.cameras.size(); ++i) {
    RigCamera& true_camera = drive.true_rig.cameras[i];
    true_camera.line_delay = options.line_delay;
    true_camera.time_shift = i % 2 == 0 ? options.time_offset : -options.time_offset;
    RigCamera& camera = drive.rig.cameras[i];
    camera.line_delay = options.line_delay * (1 + options.line_delay_error);
    const Eigen::Vector3d axis = Gaussian3(random, 1).normalized(),
                          shift = Gaussian3(random, 1).normalized();
    camera.body_from_camera.rotation =
        camera.body_from_camera.rotation *
        Eigen::Quaterniond(Eigen::AngleAxisd(options.rig_rotation_deg * M_PI / 180, axis));
    camera.body_from_camera.translation += options.rig_translation * shift;
  }
}

SampledDrive MakeDrive(Rig rig, const MotionFunction& motion,
                       const std::vector<Eigen::Vector3d>& points,
                       const SampledDriveOptions& options, Random& random, const View& view = {}) {
  SampledDrive drive;
  drive.rig = std::move(rig);
  drive.rig.imu.update_rate = options.imu_rate;
  drive.true_rig = drive.rig;
  DisturbRig(drive, options);
  MakeImu(drive, motion, options, random);
  std::normal_distribution<double> wheel_noise(0, options.wheel_noise);
  if (options.has_wheels)
    for (int k = 0; k <= options.duration * options.wheel_rate; ++k) {
      const double t = k / options.wheel_rate;
      const BodyMotion at = motion(options.start + t);
      const double speed =
          (at.world_from_body.rotation.conjugate() * at.velocity).x() / options.wheel_scale;
      drive.wheels.push_back(
          {TimeAt(t), speed == 0 ? 0 : speed + wheel_noise(random), at.angular_velocity.z()});
    }
  MakeFrames(drive, motion, points, options, view);
  std::stable_sort(drive.frames.begin(), drive.frames.end(),
                   [](const TrackedFrame& a, const TrackedFrame& b) { return a.time < b.time; });
  for (int k = 0; k <= options.duration * 100; ++k) {
    const Rigid3 pose = motion(options.start + k * 0.01).world_from_body;
    if (!drive.truth.empty())
      drive.length += (pose.translation - drive.truth.back().world_from_frame.translation).norm();
    drive.truth.push_back({TimeAt(k * 0.01), pose});
  }
  return drive;
}

}  // namespace

SampledDrive MakeCarDrive(const SampledDriveOptions& options) {
  Random random(options.seed);
  const MotionFunction motion = CarMotion(options.start + options.duration);
  return MakeDrive(CarRig(options.num_cameras), motion, PointsAlongPath(motion, options, random),
                   options, random);
}

SampledDrive MakeBendDrive(const SampledDriveOptions& options, double speed, double yaw_rate) {
  Random random(options.seed);
  const MotionFunction motion = BendMotion(speed, yaw_rate);
  Rig rig = CarRig(1);
  rig.cameras = {MakeCamera("left", {1.5, 0.27, 1.6}, 0, 0),
                 MakeCamera("right", {1.5, -0.27, 1.6}, 0, 0)};
  rig.cameras.resize(static_cast<size_t>(options.num_cameras));
  return MakeDrive(std::move(rig), motion, PointsAlongPath(motion, options, random), options,
                   random, {.max_angle = M_PI / 3, .max_range = 60, .shares_tracks = true});
}

SampledDrive MakeRestingDrive(const SampledDriveOptions& options) {
  Random random(options.seed);
  return MakeDrive(CarRig(options.num_cameras), RestingMotion(),
                   PointsAlongPath(RestingMotion(), options, random), options, random);
}

SampledDrive MakeFlight(const SampledDriveOptions& options) {
  Random random(options.seed);
  Rig rig;
  rig.cameras = {MakeCamera("cam0", {0.05, 0.02, 0.03}, 5, 3)};
  rig.imu.gyroscope_noise_density = 2e-4;
  rig.imu.accelerometer_noise_density = 2e-3;
  SampledDriveOptions flight = options;
  flight.has_wheels = false;
  const std::vector<Eigen::Vector3d> points = PointsInRoom(options, random);
  return MakeDrive(std::move(rig), FlightMotion(), points, flight, random, {.max_angle = 0.8});
}

void RemoveImages(SampledDrive& drive, int camera, double begin, double end) {
  std::erase_if(drive.frames, [&](const TrackedFrame& frame) {
    return (camera < 0 || frame.camera == camera) && TimeAt(begin) <= frame.time &&
           frame.time <= TimeAt(end);
  });
}

void RemoveImu(SampledDrive& drive, double begin, double end) {
  std::erase_if(drive.imu, [&](const ImuSample& sample) {
    return TimeAt(begin) < sample.time && sample.time < TimeAt(end);
  });
}

}  // namespace parkade
