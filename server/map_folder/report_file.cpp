#include "server/map_folder/report_file.h"

#include <nlohmann/json.hpp>
#include <string>

#include "core/files/file.h"

namespace parkade {

nlohmann::json ReadReport(const std::filesystem::path& map) {
  using Json = nlohmann::json;
  std::string member;  // of the report, of which parts are read
  return Json::parse(ReadFile(map / "report.json"),
                     [&](int depth, Json::parse_event_t event, const Json& parsed) {
                       if (event != Json::parse_event_t::key) return true;
                       if (depth == 1) member = parsed.get<std::string>();
                       return depth != 2 || member != "join" || parsed != "pairs";
                     });
}

}  // namespace parkade
