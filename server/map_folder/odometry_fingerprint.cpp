#include "server/map_folder/odometry_fingerprint.h"

#include <nlohmann/json.hpp>
#include <set>

namespace parkade {

std::string OdometryFingerprint(const nlohmann::json& options, const nlohmann::json& streams) {
  std::set<std::string> read;
  for (const nlohmann::json& stream : streams) {
    const std::string role = stream.value("role", "");
    if (role != "gnss" && !role.ends_with("/semantic"))
      read.insert(role + " " + stream.value("topic", ""));
  }
  std::string text = options.value("odometry", nlohmann::json()).dump();
  for (const std::string& stream : read) text += "\n" + stream;
  return text;
}

}  // namespace parkade
