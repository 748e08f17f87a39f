#include "server/store/tables/map_table.h"

#include "core/error.h"
#include "server/store/tables/drive_table.h"
#include "server/store/tables/names.h"
#include "server/store/tables/row.h"

namespace parkade {
namespace {

const std::string kSelect =
    "SELECT sequence, id, site, version, job, sha256, datum, bounds, created_at, "
    "review_state, files_deleted_at FROM maps ";

MapVersion FromRow(const Statement& row) {
  MapVersion map;
  map.sequence = row.Integer(0);
  map.id = row.Text(1);
  map.site = row.Text(2);
  map.version = row.Integer(3);
  map.job = row.Text(4);
  map.sha256 = row.Text(5);
  map.datum = OptionalText(row, 6);
  map.bounds = OptionalText(row, 7);
  map.created_at = row.Text(8);
  map.review_state = ReviewStateFromText(row.Text(9));
  map.files_deleted_at = OptionalText(row, 10);
  return map;
}

std::string Missing(const std::string& site, std::int64_t version) {
  return "site '" + site + "' has no map version " + std::to_string(version);
}

}  // namespace

std::int64_t NextMapVersion(Connection& connection, const std::string& site) {
  Statement query =
      connection.Query("SELECT coalesce(max(version), 0) + 1 FROM maps WHERE site = ?", site);
  query.Step();
  return query.Integer(0);
}

void InsertMap(Connection& connection, const MapVersion& map) {
  connection.Execute(
      "INSERT INTO maps (id, site, version, job, sha256, datum, bounds, created_at) VALUES (?, ?, "
      "?, ?, ?, ?, ?, ?)",
      map.id, map.site, map.version, map.job, map.sha256, map.datum, map.bounds, map.created_at);
  for (const MapFile& file : map.files)
    connection.Execute(
        "INSERT INTO map_files (map, name, bytes, sha256, pieces) VALUES (?, ?, ?, ?, ?)", map.id,
        file.name, file.bytes, file.sha256, file.pieces);
  for (size_t i = 0; i < map.drives.size(); ++i)
    connection.Execute("INSERT INTO map_drives (map, drive, position) VALUES (?, ?, ?)", map.id,
                       map.drives[i].id, i);
}

MapVersion FindMapRow(Connection& connection, const std::string& site, std::int64_t version) {
  Statement query = connection.Query(kSelect + "WHERE site = ? AND version = ?", site, version);
  Require(query.Step(), ErrorCode::kNotFound, Missing(site, version));
  return FromRow(query);
}

void RequireFiles(const MapVersion& map) {
  Require(!map.files_deleted_at, ErrorCode::kConflict,
          "the files of version " + std::to_string(map.version) + " were deleted on " +
              map.files_deleted_at.value_or("").substr(0, 10) +
              ", as the retention of its site says");
}

MapVersion FindMap(Connection& connection, const std::string& site, std::int64_t version) {
  MapVersion map = FindMapRow(connection, site, version);
  Statement files = connection.Query(
      "SELECT name, bytes, sha256 FROM map_files WHERE map = ? ORDER BY name", map.id);
  while (files.Step()) map.files.push_back({files.Text(0), files.Integer(1), files.Text(2)});
  Statement drives =
      connection.Query("SELECT drive FROM map_drives WHERE map = ? ORDER BY position", map.id);
  while (drives.Step()) map.drives.push_back(FindDriveOrTombstone(connection, drives.Text(0)));
  return map;
}

std::int64_t LatestMapVersion(Connection& connection, const std::string& site) {
  const std::int64_t next = NextMapVersion(connection, site);
  Require(next > 1, ErrorCode::kNotFound, "site '" + site + "' has no map yet");
  return next - 1;
}

std::int64_t ApprovedMapVersion(Connection& connection, const std::string& site) {
  Statement query = connection.Query(
      "SELECT max(version) FROM maps WHERE site = ? AND review_state = 'approved'", site);
  query.Step();
  Require(!query.IsNull(0), ErrorCode::kNotFound, "site '" + site + "' has no approved version");
  return query.Integer(0);
}

void MarkFilesDeleted(Connection& connection, const std::string& id, const std::string& now) {
  connection.Execute("UPDATE maps SET files_deleted_at = ? WHERE id = ?", now, id);
  connection.Execute("DELETE FROM map_files WHERE map = ?", id);
}

std::vector<MapVersion> ListMaps(Connection& connection, const std::string& site,
                                 const Page& page) {
  Statement query =
      connection.Query(kSelect + "WHERE site = ? AND sequence < ? ORDER BY sequence DESC LIMIT ?",
                       site, page.before, page.limit);
  std::vector<MapVersion> maps;
  while (query.Step()) maps.push_back(FromRow(query));
  return maps;
}

std::vector<MapVersion> ListAllMaps(Connection& connection, const Page& page,
                                    const SiteScope& scope,
                                    const std::vector<ReviewState>& states) {
  Statement query = connection.Query(
      kSelect +
          "WHERE sequence < ?1 AND (?2 IS NULL OR site IN (SELECT value FROM json_each(?2))) AND "
          "(?3 IS NULL OR review_state IN (SELECT value FROM json_each(?3))) ORDER BY sequence "
          "DESC LIMIT ?4",
      page.before, JsonOf(scope), JsonOf(states), page.limit);
  std::vector<MapVersion> maps;
  while (query.Step()) maps.push_back(FromRow(query));
  return maps;
}

PublishedFile FindMapFile(Connection& connection, const std::string& site, std::int64_t version,
                          const std::string& name) {
  Statement query = connection.Query(
      R"(SELECT maps.id, name, bytes, map_files.sha256, map_files.pieces FROM maps JOIN map_files ON map = maps.id
         WHERE site = ? AND version = ? AND name = ?)",
      site, version, name);
  Require(query.Step(), ErrorCode::kNotFound,
          Missing(site, version) + " with a file '" + name + "'");
  return {query.Text(0), {query.Text(1), query.Integer(2), query.Text(3), query.Text(4)}};
}

}  // namespace parkade
