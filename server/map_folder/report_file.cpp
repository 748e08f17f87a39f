#include "server/map_folder/report_file.h"

#include <nlohmann/json.hpp>

#include "core/files/file.h"

namespace parkade {

nlohmann::json ReadReport(const std::filesystem::path& map) {
  using Json = nlohmann::json;
  constexpr int kOfJoin = 2;  // the depth of its members
  return Json::parse(
      ReadFile(map / "report.json"), [](int depth, Json::parse_event_t event, const Json& parsed) {
        return event != Json::parse_event_t::key || depth != kOfJoin || parsed != "pairs";
      });
}

}  // namespace parkade
