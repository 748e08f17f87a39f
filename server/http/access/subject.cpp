#include "server/http/access/subject.h"

#include <array>
#include <string_view>

#include "server/store/tables/row.h"

namespace parkade {
namespace {

/// How the site and the maker of something are found by its id.
struct Kind {
  std::string_view parameter;
  const char* what;
  const char* query;
};

constexpr std::array kKinds = {
    Kind{"{drive}", "drive",
         "SELECT site, created_by FROM drives WHERE id = ? AND deleted_at IS NULL"},
    Kind{"{job}", "job",
         // Whose drives it maps, where all are of one.
         "SELECT j.site, (SELECT CASE WHEN count(DISTINCT ifnull(d.created_by, '')) = 1 THEN "
         "max(d.created_by) END FROM drives d WHERE d.id = j.new_drive OR (j.new_drive IS NULL AND "
         "d.id IN (SELECT drive FROM job_drives WHERE job = j.id))) FROM jobs j WHERE j.id = ?"},
    Kind{"{upload}", "upload", "SELECT site, created_by FROM uploads WHERE id = ?"},
    Kind{"{set}", "upload set", "SELECT site, created_by FROM upload_sets WHERE id = ?"},
    Kind{"{share}", "share link", "SELECT site, NULL FROM shares WHERE id = ?"},
};

/// The value of a parameter of the path.
std::optional<std::string> ValueOf(std::string_view parameter, const Route& route,
                                   const httplib::Request& request) {
  const size_t at = route.path.find(parameter);
  if (at == std::string_view::npos) return std::nullopt;
  const std::string_view before = route.path.substr(0, at);
  const auto number = static_cast<size_t>(std::count(before.begin(), before.end(), '{')) + 1;
  return request.matches[number].str();
}

}  // namespace

std::optional<Subject> SubjectOf(const Route& route, const httplib::Request& request,
                                 Database& database) {
  if (const auto site = ValueOf("{site}", route, request)) return Subject{"site", *site, site, ""};
  for (const Kind& kind : kKinds) {
    const auto id = ValueOf(kind.parameter, route, request);
    if (!id) continue;
    return database.Read([&](Connection& connection) -> std::optional<Subject> {
      Statement row = connection.Query(kind.query, *id);
      if (!row.Step()) return std::nullopt;
      return Subject{kind.what, *id, OptionalText(row, 0), row.Text(1)};
    });
  }
  return std::nullopt;
}

std::optional<std::int64_t> VersionOf(const Route& route, const httplib::Request& request) {
  const auto text = ValueOf("{version}", route, request);
  if (!text) return std::nullopt;
  return std::stoll(*text);
}

}  // namespace parkade
