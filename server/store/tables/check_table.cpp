#include "server/store/tables/check_table.h"

#include "server/store/tables/names.h"
#include "server/store/tables/row.h"

namespace parkade {

void SetFileCheck(Connection& connection, const std::string& path,
                  const std::optional<std::string>& damage) {
  connection.Execute(
      "INSERT INTO file_checks (path, checked_at, damage) VALUES (?, ?, ?) "
      "ON CONFLICT (path) DO UPDATE SET checked_at = excluded.checked_at, damage = excluded.damage",
      path, NowUtc(), damage);
}

std::optional<std::string> DamageOf(Connection& connection, const std::string& path) {
  Statement query = connection.Query("SELECT damage FROM file_checks WHERE path = ?", path);
  return query.Step() ? OptionalText(query, 0) : std::nullopt;
}

std::vector<std::pair<std::string, std::string>> FileCheckTimes(Connection& connection) {
  Statement query = connection.Query("SELECT path, checked_at FROM file_checks");
  std::vector<std::pair<std::string, std::string>> times;
  while (query.Step()) times.emplace_back(query.Text(0), query.Text(1));
  return times;
}

std::vector<DamagedFile> DamagedFiles(Connection& connection) {
  Statement query = connection.Query(
      "SELECT path, damage FROM file_checks WHERE damage IS NOT NULL ORDER BY path");
  std::vector<DamagedFile> files;
  while (query.Step()) files.push_back({query.Text(0), query.Text(1)});
  return files;
}

std::int64_t CountDamagedFiles(Connection& connection) {
  Statement query = connection.Query("SELECT count(*) FROM file_checks WHERE damage IS NOT NULL");
  query.Step();
  return query.Integer(0);
}

void DropFileCheck(Connection& connection, const std::string& path) {
  connection.Execute("DELETE FROM file_checks WHERE path = ?", path);
}

}  // namespace parkade
