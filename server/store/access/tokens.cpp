#include "server/store/access/tokens.h"

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "server/store/access/access_rules.h"
#include "server/store/access/audit_log.h"
#include "server/store/access/secrets.h"
#include "server/store/tables/names.h"
#include "server/store/tables/row.h"

namespace parkade {
namespace {

const std::string kSelect =
    "SELECT sequence, id, name, role, sites, pictures, created_at, expires_at, revoked_at, used_at "
    "FROM tokens ";
const std::string kUsable = "revoked_at IS NULL AND (expires_at IS NULL OR expires_at > ?)";

Token FromRow(const Statement& row) {
  Token token;
  token.sequence = row.Integer(0);
  token.id = row.Text(1);
  token.name = row.Text(2);
  token.role = RoleFromText(row.Text(3)).value_or(Role::kViewer);
  token.sites = SiteScopeFromJson(OptionalText(row, 4));
  token.may_see_pictures = row.Integer(5) != 0;
  token.created_at = row.Text(6);
  token.expires_at = OptionalText(row, 7);
  token.revoked_at = OptionalText(row, 8);
  token.used_at = OptionalText(row, 9);
  return token;
}

std::optional<Token> OneOf(Statement query) {
  if (!query.Step()) return std::nullopt;
  return FromRow(query);
}

std::string DetailOf(const Token& token) {
  return nlohmann::json{{"name", token.name},
                        {"role", ToText(token.role)},
                        {"sites", token.sites ? nlohmann::json(*token.sites) : nullptr},
                        {"pictures", token.may_see_pictures}}
      .dump();
}

}  // namespace

NewToken CreateToken(Database& database, const Token& wanted) {
  RequireLabel(wanted.name);
  for (const std::string& site : wanted.sites.value_or(std::vector<std::string>()))
    Require(IsPlainName(site), ErrorCode::kInvalidInput, "'" + site + "' is not a site's name");
  Require(!wanted.sites || !wanted.sites->empty(), ErrorCode::kInvalidInput,
          "a token is for one site at least, or for all");
  if (wanted.expires_at) RequireFuture(*wanted.expires_at);
  NewToken made{wanted, NewSecret(SecretKind::kToken)};
  made.token.id = NewId();
  made.token.created_at = NowUtc();
  database.Write([&](Connection& connection) {
    const bool is_admin_of_all = wanted.role == Role::kAdmin && !wanted.sites;
    Require(is_admin_of_all || HasTokens(connection), ErrorCode::kUsage,
            "the first token has to be an admin's for all sites, since from then on nobody gets in "
            "without a token");
    connection.Execute(
        "INSERT INTO tokens (id, name, role, sites, pictures, secret_sha256, created_at, "
        "expires_at) VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
        made.token.id, wanted.name, std::string(ToText(wanted.role)), JsonOf(wanted.sites),
        wanted.may_see_pictures ? 1 : 0, HashOfSecret(made.secret), made.token.created_at,
        wanted.expires_at);
    RecordAudit(connection, "token.create", made.token.id, DetailOf(made.token));
  });
  return made;
}

void RevokeToken(Database& database, const std::string& id) {
  database.Write([&](Connection& connection) {
    const auto token = OneOf(connection.Query(kSelect + "WHERE id = ?", id));
    Require(token.has_value(), ErrorCode::kNotFound, "there is no token '" + id + "'");
    Require(!token->revoked_at, ErrorCode::kConflict, "token '" + id + "' was revoked before");
    connection.Execute("UPDATE tokens SET revoked_at = ? WHERE id = ?", NowUtc(), id);
    connection.Execute("DELETE FROM sessions WHERE token = ?", id);
    RecordAudit(connection, "token.revoke", id, DetailOf(*token));
  });
}

std::vector<Token> ListTokens(Connection& connection, const Page& page) {
  Statement query = connection.Query(kSelect + "WHERE sequence < ? ORDER BY sequence DESC LIMIT ?",
                                     page.before, page.limit);
  std::vector<Token> tokens;
  while (query.Step()) tokens.push_back(FromRow(query));
  return tokens;
}

bool HasTokens(Connection& connection) {
  return connection.Query("SELECT 1 FROM tokens LIMIT 1").Step();
}

bool HasUsableAdmin(Connection& connection) {
  return connection
      .Query("SELECT 1 FROM tokens WHERE role = 'admin' AND sites IS NULL AND " + kUsable, NowUtc())
      .Step();
}

std::optional<Token> FindUsableToken(Connection& connection, const std::string& secret_hash) {
  return OneOf(
      connection.Query(kSelect + "WHERE secret_sha256 = ? AND " + kUsable, secret_hash, NowUtc()));
}

std::optional<Token> FindUsableTokenById(Connection& connection, const std::string& id) {
  return OneOf(connection.Query(kSelect + "WHERE id = ? AND " + kUsable, id, NowUtc()));
}

void SetTokenUsed(Connection& connection, const std::string& id, const std::string& at) {
  connection.Execute("UPDATE tokens SET used_at = ? WHERE id = ?", at, id);
}

Caller CallerOf(const Token& token) {
  Caller caller;
  caller.id = token.id;
  caller.name = token.name;
  caller.role = token.role;
  caller.may_see_pictures = token.may_see_pictures;
  caller.sites = token.sites;
  return caller;
}

Caller MakerOf(Connection& connection, const std::optional<std::string>& id) {
  const auto token = OneOf(connection.Query(kSelect + "WHERE id = ?", id));
  return token ? CallerOf(*token) : CallerWithAllRights("service");
}

}  // namespace parkade
