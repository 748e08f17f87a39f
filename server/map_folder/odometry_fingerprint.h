#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace parkade {

/// What a drive was tracked by, as text to be compared: the options of odometry, and the streams
/// that it reads. \param options  as in report.json \param streams  of a drive in report.json, or
/// of HealthToJson
std::string OdometryFingerprint(const nlohmann::json& options, const nlohmann::json& streams);

}  // namespace parkade
