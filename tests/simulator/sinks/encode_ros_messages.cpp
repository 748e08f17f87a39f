#include "tests/simulator/sinks/encode_ros_messages.h"

#include <array>
#include <bit>
#include <cstring>

namespace parkade::simulator {
namespace {

/// Appends numbers and texts the way one of the two serializations wants them.
class MessageWriter {
 public:
  explicit MessageWriter(RosEncoding encoding) : encoding_(encoding) {
    if (is_cdr()) bytes_ = {0, 1, 0, 0};  // little-endian plain CDR
  }

  template <typename T>
  void Number(T value) {
    // CDR aligns a number to its size, counted behind the encapsulation.
    while (is_cdr() && (bytes_.size() - 4) % sizeof(T) != 0) bytes_.push_back(0);
    std::array<std::uint8_t, sizeof(T)> raw;
    static_assert(std::endian::native == std::endian::little);
    std::memcpy(raw.data(), &value, sizeof(T));
    bytes_.insert(bytes_.end(), raw.begin(), raw.end());
  }

  void Text(const std::string& text) {
    Number(static_cast<std::uint32_t>(text.size() + (is_cdr() ? 1 : 0)));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
    if (is_cdr()) bytes_.push_back(0);
  }

  void ByteSequence(std::span<const std::uint8_t> bytes) {
    Number(static_cast<std::uint32_t>(bytes.size()));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }

  void Doubles(std::initializer_list<double> values) {
    for (const double value : values) Number(value);
  }

  /// A square matrix with these numbers on its diagonal.
  void Diagonal(std::initializer_list<double> diagonal) {
    size_t row = 0;
    for (const double value : diagonal) {
      for (size_t column = 0; column < diagonal.size(); ++column)
        Number(column == row ? value : 0.0);
      ++row;
    }
  }

  void Header(const RosHeader& header) {
    if (!is_cdr()) Number(header.sequence);
    Number(static_cast<std::uint32_t>(header.stamp.ns / 1'000'000'000));
    Number(static_cast<std::uint32_t>(header.stamp.ns % 1'000'000'000));
    Text(header.frame);
  }

  std::vector<std::uint8_t> Take() { return std::move(bytes_); }

 private:
  bool is_cdr() const { return encoding_ == RosEncoding::kCdr; }

  RosEncoding encoding_;
  std::vector<std::uint8_t> bytes_;
};

const std::string kSeparator = std::string(80, '=') + "\nMSG: ";

const std::string kHeader1 =
    kSeparator + "std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n";
const std::string kHeader2 = kSeparator +
                             "std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n" +
                             kSeparator + "builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
const std::string kVector3 =
    kSeparator + "geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n";
const std::string kQuaternion =
    kSeparator + "geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n";

/// `fields` without the header line; `parts`: definitions of other types within.
RosType MakeType(const std::string& package, const std::string& name, const std::string& md5,
                 const std::string& fields, const std::string& parts) {
  return {package + "/" + name, package + "/msg/" + name,
          "Header header\n" + fields + kHeader1 + parts,
          "std_msgs/Header header\n" + fields + kHeader2 + parts, md5};
}

}  // namespace

const RosType& CompressedImageType() {
  static const RosType type =
      MakeType("sensor_msgs", "CompressedImage", "8f7a12909da2c9d3332d540a0977563f",
               "string format\nuint8[] data\n", "");
  return type;
}

const RosType& ImuType() {
  static const RosType type =
      MakeType("sensor_msgs", "Imu", "6a62c6daae103f4ff57a132d6f95cec2",
               "geometry_msgs/Quaternion orientation\nfloat64[9] "
               "orientation_covariance\ngeometry_msgs/Vector3 angular_velocity\n"
               "float64[9] angular_velocity_covariance\ngeometry_msgs/Vector3 "
               "linear_acceleration\nfloat64[9] linear_acceleration_covariance\n",
               kQuaternion + kVector3);
  return type;
}

const RosType& NavSatFixType() {
  static const RosType type = MakeType(
      "sensor_msgs", "NavSatFix", "2d3a8cd499b9b4a0249fb98fd05cfa48",
      "uint8 COVARIANCE_TYPE_UNKNOWN=0\nuint8 COVARIANCE_TYPE_APPROXIMATED=1\nuint8 "
      "COVARIANCE_TYPE_DIAGONAL_KNOWN=2\nuint8 COVARIANCE_TYPE_KNOWN=3\n"
      "sensor_msgs/NavSatStatus status\nfloat64 latitude\nfloat64 longitude\nfloat64 "
      "altitude\nfloat64[9] "
      "position_covariance\nuint8 position_covariance_type\n",
      kSeparator +
          "sensor_msgs/NavSatStatus\nint8 STATUS_NO_FIX=-1\nint8 STATUS_FIX=0\nint8 "
          "STATUS_SBAS_FIX=1\nint8 "
          "STATUS_GBAS_FIX=2\n"
          "uint16 SERVICE_GPS=1\nuint16 SERVICE_GLONASS=2\nuint16 SERVICE_COMPASS=4\nuint16 "
          "SERVICE_GALILEO=8\nint8 status\nuint16 service\n");
  return type;
}

const RosType& OdometryType() {
  static const RosType type = MakeType(
      "nav_msgs", "Odometry", "cd5e73d190d741a2f92e81eda573aca7",
      "string child_frame_id\ngeometry_msgs/PoseWithCovariance "
      "pose\ngeometry_msgs/TwistWithCovariance twist\n",
      kSeparator +
          "geometry_msgs/PoseWithCovariance\ngeometry_msgs/Pose pose\nfloat64[36] covariance\n" +
          kSeparator +
          "geometry_msgs/Pose\ngeometry_msgs/Point position\ngeometry_msgs/Quaternion "
          "orientation\n" +
          kSeparator + "geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n" + kQuaternion +
          kSeparator +
          "geometry_msgs/TwistWithCovariance\ngeometry_msgs/Twist twist\nfloat64[36] covariance\n" +
          kSeparator +
          "geometry_msgs/Twist\ngeometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n" +
          kVector3);
  return type;
}

std::vector<std::uint8_t> EncodeCompressedImage(const RosHeader& header, const std::string& format,
                                                std::span<const std::uint8_t> file,
                                                RosEncoding encoding) {
  MessageWriter writer(encoding);
  writer.Header(header);
  writer.Text(format);
  writer.ByteSequence(file);
  return writer.Take();
}

std::vector<std::uint8_t> EncodeImu(const RosHeader& header, const ImuSample& sample,
                                    RosEncoding encoding) {
  MessageWriter writer(encoding);
  writer.Header(header);
  writer.Doubles({0, 0, 0, 1});
  writer.Diagonal({-1, 0, 0});  // a first element of -1: no orientation
  const Eigen::Vector3d &w = sample.angular_velocity, &a = sample.linear_acceleration;
  writer.Doubles({w.x(), w.y(), w.z()});
  writer.Diagonal({0, 0, 0});
  writer.Doubles({a.x(), a.y(), a.z()});
  writer.Diagonal({0, 0, 0});
  return writer.Take();
}

std::vector<std::uint8_t> EncodeNavSatFix(const RosHeader& header, const GnssFix& fix,
                                          RosEncoding encoding) {
  constexpr std::uint8_t kDiagonalKnown = 2;
  MessageWriter writer(encoding);
  writer.Header(header);
  writer.Number(std::int8_t{0});
  writer.Number(std::uint16_t{1});
  writer.Doubles({fix.latitude_deg, fix.longitude_deg, fix.altitude});
  const Eigen::Vector3d variance = fix.sigma_enu.cwiseAbs2();
  writer.Diagonal({variance.x(), variance.y(), variance.z()});
  writer.Number(kDiagonalKnown);
  return writer.Take();
}

std::vector<std::uint8_t> EncodeOdometry(const RosHeader& header, const std::string& child_frame,
                                         const WheelSample& sample, const Rigid3& odom_from_body,
                                         RosEncoding encoding) {
  MessageWriter writer(encoding);
  writer.Header(header);
  writer.Text(child_frame);
  const Eigen::Vector3d& position = odom_from_body.translation;
  const Eigen::Quaterniond& rotation = odom_from_body.rotation;
  writer.Doubles({position.x(), position.y(), position.z(), rotation.x(), rotation.y(),
                  rotation.z(), rotation.w()});
  writer.Diagonal({0, 0, 0, 0, 0, 0});
  writer.Doubles({sample.forward_speed, 0, 0, 0, 0, sample.yaw_rate});
  writer.Diagonal({4e-4, 1e-4, 1e-2, 1e-2, 1e-2, 1e-4});
  return writer.Take();
}

}  // namespace parkade::simulator
