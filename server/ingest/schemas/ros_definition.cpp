#include "server/ingest/schemas/ros_definition.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <sstream>

#include "core/error.h"
#include "server/ingest/containers/channel_table.h"

namespace parkade {
namespace {

constexpr std::array<std::string_view, 15> kPrimitives = {
    "bool",   "byte",  "char",   "float32", "float64", "int8",   "uint8",  "int16",
    "uint16", "int32", "uint32", "int64",   "uint64",  "string", "wstring"};

bool IsPrimitive(std::string_view type) {
  return std::find(kPrimitives.begin(), kPrimitives.end(), type) != kPrimitives.end();
}

/// "float64[3]" and the like; a bound of a text or array has no meaning here.
RosField ReadType(std::string type) {
  RosField field;
  const std::size_t bracket = type.find('[');
  if (bracket != std::string::npos) {
    field.is_array = true;
    std::size_t length = 0;
    const char* end = type.data() + type.size();
    const auto [stop, error] = std::from_chars(type.data() + bracket + 1, end, length);
    if (error == std::errc() && stop != end && *stop == ']') field.length = length;
  }
  field.type = type.substr(0, std::min(bracket, type.find("<=")));
  return field;
}

/// The field of a line, or nothing where it is empty or a constant.
std::optional<RosField> ReadLine(const std::string& line) {
  std::istringstream words(line.substr(0, line.find('#')));
  std::string type, name, rest;
  if (!(words >> type)) return std::nullopt;
  Require(static_cast<bool>(words >> name), ErrorCode::kInvalidInput,
          "the message definition has a line without a name: '" + line.substr(0, 80) + "'");
  words >> rest;
  const bool is_constant = name.find('=') != std::string::npos || rest.starts_with('=');
  if (is_constant) return std::nullopt;
  RosField field = ReadType(type);
  field.name = name;
  return field;
}

/// The full name of a type that a field of `user` names.
std::string FullName(const std::string& type, const std::string& user,
                     const RosDefinition& definition) {
  if (IsPrimitive(type)) return type;
  if (type == "Header") return "std_msgs/Header";
  if (type == "time" || type == "duration") return type;
  if (type.find('/') != std::string::npos) return Ros1TypeName(type);
  std::string beside = user.substr(0, user.find('/') + 1) + type;
  if (definition.types.contains(beside)) return beside;
  for (const auto& [name, fields] : definition.types)
    if (name.ends_with("/" + type)) return name;
  return beside;
}

/// The fields of a type behind those of the one that needs it. As rosbag2 has it: a line of 80 '='.
std::string Part(const std::string& type, const std::string& fields) {
  return std::string(80, '=') + "\nMSG: " + type + "\n" + fields;
}

constexpr const char* kHeader = "std_msgs/Header header\n";
constexpr const char* kTwist = "Vector3 linear\nVector3 angular\n";
constexpr const char* kAckermann =
    "float32 steering_angle\nfloat32 steering_angle_velocity\nfloat32 speed\n"
    "float32 acceleration\nfloat32 jerk\n";

std::string Vector3() { return Part("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"); }

std::string Layout() {
  return Part("std_msgs/MultiArrayLayout", "MultiArrayDimension[] dim\nuint32 data_offset\n") +
         Part("std_msgs/MultiArrayDimension", "string label\nuint32 size\nuint32 stride\n");
}

/// Types that a clean log has.
std::string KnownSensorDefinition(const std::string& type) {
  const std::string header = kHeader;
  if (type == "sensor_msgs/Imu")
    return header +
           "geometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
           "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
           "geometry_msgs/Vector3 linear_acceleration\n"
           "float64[9] linear_acceleration_covariance\n" +
           Part("geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n") +
           Vector3();
  if (type == "geometry_msgs/TwistStamped")
    return header + "Twist twist\n" + Part("geometry_msgs/Twist", kTwist) + Vector3();
  if (type == "sensor_msgs/NavSatFix")
    return header +
           "NavSatStatus status\nfloat64 latitude\nfloat64 longitude\nfloat64 altitude\n"
           "float64[9] position_covariance\nuint8 position_covariance_type\n" +
           Part("sensor_msgs/NavSatStatus", "int8 status\nuint16 service\n");
  if (type == "sensor_msgs/Image")
    return header +
           "uint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\n"
           "uint8[] data\n";
  if (type == "sensor_msgs/CompressedImage") return header + "string format\nuint8[] data\n";
  return "";
}

/// Foxglove's types for ROS 2.
std::string KnownFoxgloveDefinition(const std::string& type) {
  const std::string begin = "builtin_interfaces/Time timestamp\nstring frame_id\n";
  if (type == "foxglove_msgs/CompressedImage") return begin + "uint8[] data\nstring format\n";
  if (type == "foxglove_msgs/RawImage")
    return begin + "uint32 width\nuint32 height\nstring encoding\nuint32 step\nuint8[] data\n";
  if (type == "foxglove_msgs/LocationFix")
    return begin +
           "float64 latitude\nfloat64 longitude\nfloat64 altitude\n"
           "float64[9] position_covariance\nuint8 position_covariance_type\n";
  return "";
}

}  // namespace

void AddKnownTypes(RosDefinition& definition, bool is_ros1) {
  const std::vector<RosField> time = {{is_ros1 ? "uint32" : "int32", "sec"},
                                      {"uint32", is_ros1 ? "nsec" : "nanosec"}};
  for (const char* name :
       {"time", "duration", "builtin_interfaces/Time", "builtin_interfaces/Duration"})
    definition.types.try_emplace(name, time);
  std::vector<RosField> header = {{"time", "stamp"}, {"string", "frame_id"}};
  if (is_ros1) header.insert(header.begin(), {"uint32", "seq"});
  definition.types.try_emplace("std_msgs/Header", header);
}

RosDefinition ReadRosDefinition(const std::string& text, const std::string& type, bool is_ros1) {
  RosDefinition definition;
  definition.main = type;
  std::string current = type;
  definition.types[current];
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("====")) {
      current.clear();
    } else if (line.starts_with("MSG:")) {
      std::istringstream(line.substr(4)) >> current;
      current = Ros1TypeName(current);
      definition.types[current];
    } else if (const std::optional<RosField> field = ReadLine(line); field && !current.empty()) {
      definition.types[current].push_back(*field);
    }
  }
  AddKnownTypes(definition, is_ros1);
  for (auto& [user, fields] : definition.types)
    for (RosField& field : fields) field.type = FullName(field.type, user, definition);
  return definition;
}

std::string KnownRosDefinition(const std::string& type) {
  const std::string header = kHeader;
  for (std::string known : {KnownSensorDefinition(type), KnownFoxgloveDefinition(type)})
    if (!known.empty()) return known;
  if (type == "sensor_msgs/JointState")
    return header + "string[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n";
  if (type == "geometry_msgs/Twist") return kTwist + Vector3();
  if (type == "ackermann_msgs/AckermannDrive") return kAckermann;
  if (type == "ackermann_msgs/AckermannDriveStamped")
    return header + "AckermannDrive drive\n" + Part("ackermann_msgs/AckermannDrive", kAckermann);
  if (type == "can_msgs/Frame")
    return header +
           "uint32 id\nbool is_rtr\nbool is_extended\nbool is_error\nuint8 dlc\nuint8[8] data\n";
  for (const char* number : {"Float32", "Float64", "Int32", "Int64", "Int16"}) {
    std::string lower = number;
    lower.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(lower.front())));
    if (type == std::string("std_msgs/") + number) return lower + " data\n";
    if (type == std::string("std_msgs/") + number + "MultiArray")
      return "MultiArrayLayout layout\n" + lower + "[] data\n" + Layout();
  }
  return "";
}

std::string WholeRos2Definition(const std::string& type) {
  return KnownRosDefinition(type) +
         Part("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n") +
         Part("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n");
}

}  // namespace parkade
