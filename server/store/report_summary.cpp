#include "server/store/report_summary.h"

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files/file.h"
#include "core/files/foreign_json.h"

namespace parkade {
namespace {

constexpr size_t kMaxReportBytes = size_t{64} << 20;

std::optional<std::string> ObjectAt(const nlohmann::json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_object()) return std::nullopt;
  return found->dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace

ReportSummary ReadReportSummary(const std::filesystem::path& report) {
  const nlohmann::json json = ParseForeignJson(ReadFile(report, kMaxReportBytes));
  Require(json.is_object(), ErrorCode::kInternal, "the worker's report.json is not a JSON object");

  ReportSummary summary;
  summary.datum = ObjectAt(json, "datum");
  summary.bounds = ObjectAt(json, "bounds");
  if (const auto left_out = json.find("left_out"); left_out != json.end() && left_out->is_array())
    for (const nlohmann::json& drive : *left_out)
      if (drive.is_object() && drive.contains("name") && drive["name"].is_string())
        summary.left_out[drive["name"]] = drive.value("reason", "it is left out of the map");
  const auto drives = json.find("drives");
  if (drives == json.end() || !drives->is_array()) return summary;
  for (const nlohmann::json& drive : *drives) {
    if (!drive.is_object() || !drive.contains("name") || !drive["name"].is_string() ||
        !drive.contains("streams"))
      continue;
    summary.streams_of_drive[drive["name"]] =
        drive["streams"].dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }
  return summary;
}

}  // namespace parkade
