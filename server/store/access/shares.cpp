#include "server/store/access/shares.h"

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "server/store/access/access_rules.h"
#include "server/store/access/audit_log.h"
#include "server/store/access/secrets.h"
#include "server/store/tables/map_table.h"
#include "server/store/tables/names.h"
#include "server/store/tables/row.h"
#include "server/store/tables/site_table.h"

namespace parkade {
namespace {

const std::string kSelect =
    "SELECT sequence, id, name, site, version, created_by, created_at, expires_at, revoked_at FROM "
    "shares ";
const std::string kUsable = "revoked_at IS NULL AND expires_at > ?";

Share FromRow(const Statement& row) {
  Share share;
  share.sequence = row.Integer(0);
  share.id = row.Text(1);
  share.name = row.Text(2);
  share.site = row.Text(3);
  share.version = OptionalInteger(row, 4);
  share.created_by = row.Text(5);
  share.created_at = row.Text(6);
  share.expires_at = row.Text(7);
  share.revoked_at = OptionalText(row, 8);
  return share;
}

std::optional<Share> OneOf(Statement query) {
  if (!query.Step()) return std::nullopt;
  return FromRow(query);
}

std::string DetailOf(const Share& share) {
  nlohmann::json detail = {
      {"name", share.name}, {"site", share.site}, {"expires_at", share.expires_at}};
  if (share.version) detail["version"] = *share.version;
  return detail.dump();
}

}  // namespace

NewShare CreateShare(Database& database, const Share& wanted) {
  RequireLabel(wanted.name);
  RequireFuture(wanted.expires_at);
  NewShare made{wanted, NewSecret(SecretKind::kShare)};
  made.share.id = NewId();
  made.share.created_by = CurrentCaller().name;
  made.share.created_at = NowUtc();
  database.Write([&](Connection& connection) {
    FindSite(connection, wanted.site);
    if (wanted.version) FindMap(connection, wanted.site, *wanted.version);
    connection.Execute(
        "INSERT INTO shares (id, name, site, version, secret_sha256, created_by, created_at, "
        "expires_at) VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
        made.share.id, wanted.name, wanted.site, wanted.version, HashOfSecret(made.secret),
        made.share.created_by, made.share.created_at, wanted.expires_at);
    RecordAudit(connection, "share.create", made.share.id, DetailOf(made.share));
  });
  return made;
}

void RevokeShare(Database& database, const std::string& id) {
  database.Write([&](Connection& connection) {
    const auto share = OneOf(connection.Query(kSelect + "WHERE id = ?", id));
    Require(share.has_value(), ErrorCode::kNotFound, "there is no share link '" + id + "'");
    Require(!share->revoked_at, ErrorCode::kConflict, "share link '" + id + "' was revoked before");
    connection.Execute("UPDATE shares SET revoked_at = ? WHERE id = ?", NowUtc(), id);
    connection.Execute("DELETE FROM sessions WHERE share = ?", id);
    RecordAudit(connection, "share.revoke", id, DetailOf(*share));
  });
}

std::vector<Share> ListShares(Connection& connection, const Page& page, const SiteScope& scope) {
  Statement query = connection.Query(
      kSelect +
          "WHERE sequence < ? AND (?2 IS NULL OR site IN (SELECT value FROM json_each(?2))) ORDER "
          "BY sequence DESC LIMIT ?",
      page.before, JsonOf(scope), page.limit);
  std::vector<Share> shares;
  while (query.Step()) shares.push_back(FromRow(query));
  return shares;
}

std::optional<Share> FindUsableShare(Connection& connection, const std::string& secret_hash) {
  return OneOf(
      connection.Query(kSelect + "WHERE secret_sha256 = ? AND " + kUsable, secret_hash, NowUtc()));
}

std::optional<Share> FindUsableShareById(Connection& connection, const std::string& id) {
  return OneOf(connection.Query(kSelect + "WHERE id = ? AND " + kUsable, id, NowUtc()));
}

Caller CallerOf(const Share& share) {
  Caller caller;
  caller.id = share.id;
  caller.name = share.name;
  caller.has_link_only = true;
  caller.sites = std::vector{share.site};
  caller.version = share.version;
  return caller;
}

}  // namespace parkade
