#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/rig.h"
#include "server/ingest/checks/finding.h"
#include "server/ingest/containers/raw_message.h"
#include "server/ingest/inspection/topic_inspection.h"

namespace parkade {

enum class LogState {
  kClean,     ///< all of it can be read
  kLossy,     ///< some of it is lost, the rest can be used
  kUnusable,  ///< no IMU, no images, a rig was given that does not fit, or what was found says so
};

struct LogInspection {
  std::string name;
  std::string format;  ///< "ROS 1 bag", "MCAP", ...
  std::uint64_t num_bytes = 0;
  TimeSpan span;  ///< of the drive where it can be mapped, else of all stamps
  std::vector<TopicInspection> topics;
  DamageReport damage;  ///< of the container
  std::optional<Rig> rig;
  std::vector<std::string> missing;  ///< one sentence each, on what prevents a map
  std::vector<Finding> findings;     ///< what else is wrong, and what a map has to do without
  LogState state = LogState::kClean;
  /// A large log that its beginning shows to be unusable is read no further: what is told of topics
  /// is told of that.
  bool is_of_beginning = false;

  /// The exit status of `parkade inspect`: 0 clean, 3 lossy, 1 unusable.
  int ExitStatus() const {
    return state == LogState::kClean ? 0 : state == LogState::kLossy ? 3 : 1;
  }
};

}  // namespace parkade
