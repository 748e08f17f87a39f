#include "server/store/tables/rig_table.h"

#include <sstream>

namespace parkade {
namespace {

const std::string kSelect = "SELECT sequence, id, name, sha256, files, created_at FROM rigs ";

// Names of rig files are plain (server/store/tables/names.h): a space separates them.
StoredRig FromRow(const Statement& row) {
  StoredRig rig;
  rig.sequence = row.Integer(0);
  rig.id = row.Text(1);
  rig.name = row.Text(2);
  rig.sha256 = row.Text(3);
  std::istringstream files(row.Text(4));
  for (std::string file; files >> file;) rig.files.push_back(file);
  rig.created_at = row.Text(5);
  return rig;
}

}  // namespace

void InsertRig(Connection& connection, const StoredRig& rig) {
  std::string files;
  for (const std::string& file : rig.files) files += (files.empty() ? "" : " ") + file;
  connection.Execute(
      "INSERT INTO rigs (id, name, sha256, files, created_at) VALUES (?, ?, ?, ?, ?)", rig.id,
      rig.name, rig.sha256, files, rig.created_at);
}

std::optional<StoredRig> FindRig(Connection& connection, const std::string& name) {
  Statement query =
      connection.Query(kSelect + "WHERE name = ? ORDER BY sequence DESC LIMIT 1", name);
  if (!query.Step()) return std::nullopt;
  return FromRow(query);
}

std::vector<StoredRig> ListRigs(Connection& connection, const Page& page) {
  Statement query = connection.Query(
      kSelect +
          "WHERE sequence IN (SELECT max(sequence) FROM rigs GROUP BY name) AND sequence < ? "
          "ORDER BY sequence DESC LIMIT ?",
      page.before, page.limit);
  std::vector<StoredRig> rigs;
  while (query.Step()) rigs.push_back(FromRow(query));
  return rigs;
}

}  // namespace parkade
