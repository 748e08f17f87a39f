#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace parkade {

/// The parts of a map's report.json that lists of sites and drives show. Each value is JSON text;
/// absent where the report does not say.
struct ReportSummary {
  std::optional<std::string> datum;   ///< "datum": {latitude_deg, longitude_deg, altitude}
  std::optional<std::string> bounds;  ///< "bounds": {min: [x, y, z], max: [x, y, z]} in site [m]
  std::map<std::string, std::string> streams_of_drive;  ///< "drives": [{name, streams}], by name
  std::map<std::string, std::string>
      left_out;  ///< "left_out": [{name, reason}], plain text by name
};

/// Throws Error{kInternal} when the file is missing or not a JSON object.
ReportSummary ReadReportSummary(const std::filesystem::path& report);

}  // namespace parkade
