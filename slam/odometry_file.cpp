#include "slam/odometry_file.h"

#include <algorithm>
#include <memory>

#include "core/file.h"
#include "slam/binary_exchange.h"
#include "slam/drive_measurements.h"

namespace parkade {
namespace {

constexpr std::string_view kMagic = "parkade odometry";
constexpr std::uint32_t kVersion = 2;  // of the layout: other versions are tracked again
constexpr size_t kMaxBytes = size_t{16} << 30;

/// FNV-1a over 64 bits: finds damage, not malice.
std::uint64_t ChecksumOf(std::string_view bytes) {
  std::uint64_t sum = 14695981039346656037ULL;
  for (const char byte : bytes) sum = (sum ^ static_cast<unsigned char>(byte)) * 1099511628211ULL;
  return sum;
}

std::string_view BytesOf(const Eigen::Ref<const Eigen::VectorXd>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), sizeof(double) * static_cast<size_t>(numbers.size())};
}

/// Of all that tracking takes from a rig. A lens counts by the rays of some of its pixels.
std::uint64_t FingerprintOf(const Rig& rig) {
  std::string bytes;
  const auto add_pose = [&bytes](const Rigid3& pose) {
    bytes += BytesOf(pose.rotation.coeffs());
    bytes += BytesOf(pose.translation);
  };
  for (const RigCamera& camera : rig.cameras) {
    bytes += camera.name;
    add_pose(camera.body_from_camera);
    bytes +=
        BytesOf(Eigen::Vector4d(camera.time_shift, camera.line_delay, camera.model.width(), camera.model.height()));
    constexpr int kRaysPerSide = 7;
    for (int i = 0; i < kRaysPerSide * kRaysPerSide; ++i) {
      const Eigen::Vector2d at((i % kRaysPerSide + 0.5) / kRaysPerSide * camera.model.width(),
                               (i / kRaysPerSide + 0.5) / kRaysPerSide * camera.model.height());
      bytes += BytesOf(camera.model.Unproject(at).value_or(Eigen::Vector3d::Zero()));
    }
    for (int row = 0; row < camera.mask.rows; ++row)
      bytes.append(camera.mask.ptr<char>(row), static_cast<size_t>(camera.mask.cols));
  }
  const ImuCalibration& imu = rig.imu;
  bytes += BytesOf(Eigen::Vector4d(imu.accelerometer_noise_density, imu.accelerometer_random_walk,
                                   imu.gyroscope_noise_density, imu.gyroscope_random_walk));
  add_pose(rig.body_from_imu);
  if (rig.vehicle) bytes += BytesOf(Eigen::Vector2d(rig.vehicle->wheelbase, rig.vehicle->track));
  return ChecksumOf(bytes);
}

// What a file holds of one camera beyond its lens.
struct StoredCamera {
  std::string name;
  Rigid3 body_from_camera;
  double time_shift = 0, line_delay = 0;
};

struct StoredInterval {
  std::vector<ImuSample> samples;
  ImuBias bias;
  std::optional<WheelPreintegration> wheels;
  bool is_still = false;
};

struct StoredKnot {
  std::int64_t number = 0;
  MotionState state;
  Eigen::Matrix<double, 6, 6> covariance;
  std::optional<StoredInterval> interval;
};

}  // namespace

// Found by argument-dependent lookup, hence in the types' own namespace. In the order of the file: a change needs a new
// kVersion.
template <typename A>
void Exchange(A& archive, OdometryKeyframe& keyframe) {
  archive(keyframe.time, keyframe.camera, keyframe.odom_from_body);
}
template <typename A>
void Exchange(A& archive, OdometryLandmark& landmark) {
  archive(landmark.time, landmark.camera, landmark.point_in_odom, landmark.sigma, landmark.num_observations);
}
template <typename A>
void Exchange(A& archive, DegradedInterval& interval) {
  archive(interval.begin, interval.end, interval.reason);
}
template <typename A>
void Exchange(A& archive, CameraHealth& health) {
  archive(health.name, health.frames, health.frames_used, health.frames_rejected, health.tracks_per_frame,
          health.noise_scale);
}
template <typename A>
void Exchange(A& archive, CalibratedQuantity& quantity) {
  archive(quantity.name, quantity.change, quantity.sigma, quantity.status);
}
template <typename A>
void Exchange(A& archive, CameraCalibration& calibration) {
  archive(calibration.name, calibration.quantities);
}
template <typename A>
void Exchange(A& archive, OdometryReport& report) {
  archive(report.start_kind, report.start_time, report.start_data, report.cameras, report.calibration, report.degraded,
          report.knots, report.solves, report.mean_solve_seconds, report.max_solve_seconds, report.mean_bearings,
          report.seconds, report.length, report.still_seconds, report.has_wheels, report.wheel_scale,
          report.gyroscope_bias, report.accelerometer_bias);
}
template <typename A>
void Exchange(A& archive, MotionState& state) {
  archive(state.time, state.odom_from_imu, state.velocity_in_odom, state.gyroscope_bias, state.accelerometer_bias);
}
template <typename A>
void Exchange(A& archive, ImuSample& sample) {
  archive(sample.time, sample.angular_velocity, sample.linear_acceleration);
}
template <typename A>
void Exchange(A& archive, ImuBias& bias) {
  archive(bias.gyroscope, bias.accelerometer);
}
template <typename A>
void Exchange(A& archive, WheelPreintegration& wheels) {
  archive(wheels.duration, wheels.displacement, wheels.d_gyroscope_bias, wheels.gyroscope_bias, wheels.covariance,
          wheels.body_in_imu);
}
template <typename A>
void Exchange(A& archive, KnotInterpolation& interpolation) {
  archive(interpolation.fraction, interpolation.rotation_since_first, interpolation.rotation_over_interval,
          interpolation.bend);
}
template <typename A>
void Exchange(A& archive, RecordedSighting& sighting) {
  archive(sighting.track, sighting.bearing, sighting.sigma, sighting.row);
}
template <typename A>
void Exchange(A& archive, RecordedImage& image) {
  archive(image.time, image.camera, image.time_offset, image.first_knot, image.second_knot, image.interpolation,
          image.angular_velocity, image.sightings);
}
template <typename A>
void Exchange(A& archive, CameraParameters& camera) {
  archive(camera.extrinsics, camera.timing);
}
template <typename A>
void Exchange(A& archive, CameraSigmas& sigmas) {
  archive(sigmas.rotation, sigmas.translation, sigmas.time_offset, sigmas.line_delay);
}

namespace {

template <typename A>
void Exchange(A& archive, StoredCamera& camera) {
  archive(camera.name, camera.body_from_camera, camera.time_shift, camera.line_delay);
}
template <typename A>
void Exchange(A& archive, StoredInterval& interval) {
  archive(interval.samples, interval.bias, interval.wheels, interval.is_still);
}
template <typename A>
void Exchange(A& archive, StoredKnot& knot) {
  archive(knot.number, knot.state, knot.covariance, knot.interval);
}

/// The whole content, between its two forms.
struct StoredOdometry {
  std::vector<TrajectoryState> states;
  std::vector<OdometryKeyframe> keyframes;
  std::vector<OdometryLandmark> landmarks;
  std::vector<StoredCamera> cameras;
  OdometryReport report;
  std::vector<StoredKnot> knots;
  DriveMeasurements measurements;  ///< without its knots
};

template <typename A>
void Exchange(A& archive, StoredOdometry& stored) {
  DriveMeasurements& measurements = stored.measurements;
  archive(stored.states, stored.keyframes, stored.landmarks, stored.cameras, stored.report, stored.knots,
          measurements.images, measurements.cameras, measurements.camera_priors, measurements.camera_noise_scales,
          measurements.wheel_scale, measurements.has_jumps);
}

StoredKnot Stored(const RecordedKnot& knot) {
  StoredKnot stored{knot.number, knot.state, knot.covariance, {}};
  if (knot.interval)
    stored.interval = StoredInterval{knot.interval->imu.samples(), knot.interval->imu.bias(), knot.interval->wheels,
                                     knot.interval->is_still};
  return stored;
}

RecordedKnot Restored(const StoredKnot& stored, const ImuCalibration& imu) {
  RecordedKnot knot{stored.number, stored.state, stored.covariance, {}};
  if (!stored.interval) return knot;
  Require(stored.interval->samples.size() > 1, ErrorCode::kInvalidInput, "it holds a stretch without IMU data");
  knot.interval = KnotInterval{ImuPreintegration(stored.interval->samples, stored.interval->bias, imu),
                               stored.interval->wheels, stored.interval->is_still};
  return knot;
}

OdometryResult Restored(StoredOdometry&& stored, const Rig& rig) {
  OdometryResult odometry;
  odometry.odom_from_body = Trajectory(std::move(stored.states));
  odometry.keyframes = std::move(stored.keyframes);
  odometry.landmarks = std::move(stored.landmarks);
  odometry.report = std::move(stored.report);
  odometry.rig = rig;
  Require(stored.cameras.size() == rig.cameras.size(), ErrorCode::kInvalidInput,
          "it was made with " + std::to_string(stored.cameras.size()) + " cameras, not " +
              std::to_string(rig.cameras.size()));
  for (size_t i = 0; i < rig.cameras.size(); ++i) {
    const StoredCamera& camera = stored.cameras[i];
    RigCamera& restored = odometry.rig.cameras[i];
    Require(camera.name == restored.name, ErrorCode::kInvalidInput,
            "it was made with camera '" + camera.name + "' where the log has '" + restored.name + "'");
    restored.body_from_camera = camera.body_from_camera;
    restored.time_shift = camera.time_shift;
    restored.line_delay = camera.line_delay;
  }
  auto measurements = std::make_shared<DriveMeasurements>(std::move(stored.measurements));
  for (const StoredKnot& knot : stored.knots) measurements->knots.push_back(Restored(knot, rig.imu));
  odometry.measurements = std::move(measurements);
  return odometry;
}

}  // namespace

void WriteOdometry(const OdometryResult& odometry, const Rig& rig, const std::filesystem::path& file) {
  StoredOdometry stored;
  stored.states = odometry.odom_from_body.states();
  stored.keyframes = odometry.keyframes;
  stored.landmarks = odometry.landmarks;
  stored.report = odometry.report;
  for (const RigCamera& camera : odometry.rig.cameras)
    stored.cameras.push_back({camera.name, camera.body_from_camera, camera.time_shift, camera.line_delay});
  if (odometry.measurements) {
    for (const RecordedKnot& knot : odometry.measurements->knots) stored.knots.push_back(Stored(knot));
    const DriveMeasurements& all = *odometry.measurements;
    stored.measurements = {
        {}, all.images, all.cameras, all.camera_priors, all.camera_noise_scales, all.wheel_scale, all.has_jumps};
  }
  BinaryWriter content;
  content(stored);
  BinaryWriter head;
  std::uint32_t version = kVersion;
  std::uint64_t fingerprint = FingerprintOf(rig), checksum = ChecksumOf(content.bytes());
  head(version, fingerprint, checksum);
  WriteFileAtomically(file, std::string(kMagic) + head.bytes() + content.bytes());
}

OdometryResult ReadOdometry(const std::filesystem::path& file, const Rig& rig) {
  const std::string bytes = ReadFile(file, kMaxBytes);
  const std::string name = "'" + file.filename().string() + "' ";
  std::string_view rest = bytes;
  Require(rest.starts_with(kMagic), ErrorCode::kInvalidInput, name + "holds no odometry");
  rest.remove_prefix(kMagic.size());
  std::uint32_t version = 0;
  std::uint64_t fingerprint = 0, checksum = 0;
  BinaryReader head(rest);
  head(version, fingerprint, checksum);
  Require(version == kVersion, ErrorCode::kInvalidInput,
          name + "is of version " + std::to_string(version) + ", this program reads " + std::to_string(kVersion) +
              ": track the drive again");
  Require(fingerprint == FingerprintOf(rig), ErrorCode::kInvalidInput, name + "was made with another calibration");
  rest.remove_prefix(sizeof version + sizeof fingerprint + sizeof checksum);
  Require(ChecksumOf(rest) == checksum, ErrorCode::kInvalidInput, name + "is damaged");
  StoredOdometry stored;
  BinaryReader content(rest);
  content(stored);
  Require(content.is_at_end(), ErrorCode::kInvalidInput, name + "is longer than it says");
  return Restored(std::move(stored), rig);
}

}  // namespace parkade
