#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
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
  kUnusable,  ///< no IMU, no images, or a rig was given that does not fit
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

  /// The exit status of `parkade inspect`: 0 clean, 3 lossy, 1 unusable.
  int ExitStatus() const;
};

/// Reads a whole log and decodes every message and image, on all cores. Throws Error when it is no
/// log at all.
LogInspection InspectLog(const std::filesystem::path& log,
                         const std::filesystem::path& rig_folder = {},
                         const std::filesystem::path& scratch_folder = {});

std::string InspectionToText(const LogInspection& inspection);
nlohmann::json InspectionToJson(const LogInspection& inspection);

}  // namespace parkade
