#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace parkade {

/// A field of a ROS message.
struct RosField {
  std::string type;  ///< "float64", or that of a message: "geometry_msgs/Vector3"
  std::string name;
  bool is_array = false;
  std::optional<std::size_t> length = {};  ///< of an array of fixed length
};

/// A type of messages and those that it needs.
struct RosDefinition {
  std::string main;                                    ///< "geometry_msgs/Twist"
  std::map<std::string, std::vector<RosField>> types;  ///< by name in ROS 1 spelling
};

/// Reads the text of a .msg file, followed by those of other types, each under a line of '=' and
/// "MSG: package/Type". std_msgs/Header and times are known without. Throws Error{kInvalidInput}
/// when a line is no field.
RosDefinition ReadRosDefinition(const std::string& text, const std::string& type, bool is_ros1);

/// Adds std_msgs/Header and times, where the definition has none of its own.
void AddKnownTypes(RosDefinition& definition, bool is_ros1);

/// The text for common types (ROS 1 spelling), of which rosbag2 databases hold the name alone;
/// empty for others.
std::string KnownRosDefinition(const std::string& type);

/// The same with the parts that ROS 2 has for every message with a header: what other programs need
/// to read the type.
std::string WholeRos2Definition(const std::string& type);

}  // namespace parkade
