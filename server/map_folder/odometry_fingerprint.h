#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace parkade {

/// Identifies how a drive was tracked, as text to be compared: the options of odometry and the
/// streams that it reads. \param options in the form of report.json \param streams  of a drive in
/// report.json, or of HealthToJson
std::string OdometryFingerprint(const nlohmann::json& options, const nlohmann::json& streams);

}  // namespace parkade
