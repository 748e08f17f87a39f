#include "server/ingest/messages/sensor_decoding.h"

#include "core/error.h"
#include "server/ingest/files/euroc_csv.h"

namespace parkade {
namespace {

const Eigen::Vector3d kUnknownSigma(5, 5, 10);  // [m]

/// The numbers of an EuRoC line after its stamp, at least `min_count`.
std::vector<double> ReadEurocNumbers(const RawMessage& message, std::size_t min_count) {
  const std::string_view line(reinterpret_cast<const char*>(message.data.data()),
                              message.data.size());
  const std::vector<std::string_view> fields = SplitCsv(line);
  std::vector<double> numbers;
  for (std::size_t i = 1; i < fields.size(); ++i) {
    const std::optional<double> number = ParseDouble(fields[i]);
    if (!number) break;
    numbers.push_back(*number);
  }
  Require(numbers.size() >= min_count, ErrorCode::kInvalidInput,
          "a line of data.csv has too few numbers");
  return numbers;
}

/// Where receivers without a position say that they are: in the Gulf of Guinea.
bool IsNullIsland(double latitude_deg, double longitude_deg) {
  constexpr double kNear = 1e-6;  // [deg] a tenth of a meter
  return std::abs(latitude_deg) < kNear && std::abs(longitude_deg) < kNear;
}

/// A fix without altitude still says where the car is.
GnssFix WithSureAltitude(GnssFix fix) {
  if (std::isfinite(fix.altitude)) return fix;
  fix.altitude = 0;
  fix.sigma_enu.z() = GnssFix::kUnknownAltitude;
  return fix;
}

GnssFix ReadEurocFix(const RawMessage& message, Timestamp time) {
  const std::vector<double> numbers = ReadEurocNumbers(message, 3);
  GnssFix fix{time, numbers[0], numbers[1], numbers[2], kUnknownSigma};
  if (numbers.size() >= 6) fix.sigma_enu = {numbers[3], numbers[4], numbers[5]};
  return WithSureAltitude(fix);
}

Eigen::Vector3d SigmaOf(const NavSatMessage& message) {
  constexpr int kUnknownCovariance = 0;
  const Eigen::Vector3d variance(message.covariance[0], message.covariance[4],
                                 message.covariance[8]);
  if (message.covariance_type == kUnknownCovariance || !(variance.array() > 0).all())
    return kUnknownSigma;
  return variance.cwiseSqrt();
}

}  // namespace

Timestamp StampOf(const RawMessage& message, MessageEncoding encoding, const std::string& type) {
  if (encoding == MessageEncoding::kEuroc) return message.log_time;
  const Timestamp stamp = DecodeHeader(message.data, encoding, type).stamp;
  return stamp.ns == 0 ? message.log_time : stamp;
}

ImuSample ReadImuSample(const RawMessage& message, const SensorStream& stream) {
  const Timestamp time = StampOf(message, stream.encoding, stream.type);
  if (stream.encoding == MessageEncoding::kEuroc) {
    const std::vector<double> numbers = ReadEurocNumbers(message, 6);
    return {time, Eigen::Map<const Eigen::Vector3d>(numbers.data()),
            Eigen::Map<const Eigen::Vector3d>(&numbers[3])};
  }
  const ImuMessage imu = DecodeImu(message.data, stream.encoding);
  return {time, imu.angular_velocity, imu.linear_acceleration};
}

std::optional<GnssFix> ReadGnssFix(const RawMessage& message, const SensorStream& stream) {
  const Timestamp time = StampOf(message, stream.encoding, stream.type);
  if (stream.encoding == MessageEncoding::kEuroc) return ReadEurocFix(message, time);
  const NavSatMessage fix = DecodeNavSat(message.data, stream.encoding);
  if (fix.status < 0 || IsNullIsland(fix.latitude_deg, fix.longitude_deg)) return std::nullopt;
  return WithSureAltitude({time, fix.latitude_deg, fix.longitude_deg, fix.altitude, SigmaOf(fix)});
}

OdometryMessage ReadOdometry(const RawMessage& message, const SensorStream& stream) {
  if (stream.encoding != MessageEncoding::kEuroc)
    return DecodeOdometry(message.data, stream.encoding, stream.type);
  const std::vector<double> numbers = ReadEurocNumbers(message, 2);
  OdometryMessage odometry;
  odometry.linear = {numbers[0], 0, 0};
  odometry.angular = {0, 0, numbers[1]};
  return odometry;
}

std::optional<WheelSample> WheelReader::Read(const RawMessage& message,
                                             const SensorStream& stream) {
  const OdometryMessage odometry = ReadOdometry(message, stream);
  const Timestamp time = StampOf(message, stream.encoding, stream.type);
  const std::optional<WheelSample> from_poses = FromPoses(time, odometry);
  if (odometry.linear.x() != 0 || odometry.angular.z() != 0) has_twist_ = true;
  if (odometry.has_pose) {
    if (last_time_)
      path_length_ += (odometry.odom_from_child.translation - last_pose_.translation).norm();
    has_pose_ = true;
    last_pose_ = odometry.odom_from_child;
    last_time_ = time;
  }
  if (stream.is_speed_from_pose) return from_poses;
  return WheelSample{time, odometry.linear.x(), odometry.angular.z()};
}

std::optional<WheelSample> WheelReader::FromPoses(Timestamp time,
                                                  const OdometryMessage& message) const {
  if (!message.has_pose || !last_time_ || time <= *last_time_) return std::nullopt;
  const double seconds = time - *last_time_;
  const Rigid3 last_from_now = last_pose_.Inverse() * message.odom_from_child;
  const Eigen::Vector3d turn = LogSo3(last_from_now.rotation);
  // The chord of an arc in the frame midway along it.
  const Eigen::Vector3d chord = ExpSo3(-turn / 2) * last_from_now.translation;
  return WheelSample{*last_time_ + seconds / 2, chord.x() / seconds, turn.z() / seconds};
}

bool IsPlausible(const ImuSample& sample) {
  constexpr double kMaxRate = 70, kMaxAcceleration = 2000;  // [rad/s], [m/s^2]
  return sample.angular_velocity.cwiseAbs().maxCoeff() <= kMaxRate &&
         sample.angular_velocity.allFinite() &&
         sample.linear_acceleration.cwiseAbs().maxCoeff() <= kMaxAcceleration &&
         sample.linear_acceleration.allFinite();
}

bool IsPlausible(const WheelSample& sample) {
  constexpr double kMaxSpeed = 150, kMaxYawRate = 70;  // [m/s], [rad/s]
  return std::abs(sample.forward_speed) <= kMaxSpeed && std::abs(sample.yaw_rate) <= kMaxYawRate;
}

bool IsPlausible(const GnssFix& fix) {
  return std::abs(fix.latitude_deg) <= 90 && std::abs(fix.longitude_deg) <= 360 &&
         std::abs(fix.altitude) <= 1e5 && (fix.sigma_enu.array() > 0).all() &&
         (fix.sigma_enu.array() < 1e6).all();
}

}  // namespace parkade
