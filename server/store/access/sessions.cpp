#include "server/store/access/sessions.h"

#include <chrono>

#include "core/files/sha256.h"
#include "server/store/access/audit_log.h"
#include "server/store/access/secrets.h"
#include "server/store/access/shares.h"
#include "server/store/access/tokens.h"
#include "server/store/tables/names.h"
#include "server/store/tables/row.h"

namespace parkade {
namespace {

using namespace std::chrono_literals;

constexpr auto kLifetime = 12h;
constexpr auto kIdleTime = 1h;
constexpr auto kNotedEvery = 5min;  // uses in between cost no write

struct Session {
  std::optional<std::string> token, share;
  std::string used_at;
};

std::optional<Session> FindSession(Connection& connection, const std::string& hash) {
  Statement query = connection.Query(
      "SELECT token, share, used_at FROM sessions WHERE secret_sha256 = ? AND expires_at > ? AND "
      "used_at > ?",
      hash, NowUtc(), UtcIn(-kIdleTime));
  if (!query.Step()) return std::nullopt;
  return Session{OptionalText(query, 0), OptionalText(query, 1), query.Text(2)};
}

std::optional<Caller> CallerOfRow(Connection& connection, const Session& session) {
  if (session.token) {
    const auto token = FindUsableTokenById(connection, *session.token);
    if (token) return CallerOf(*token);
  } else if (session.share) {
    const auto share = FindUsableShareById(connection, *session.share);
    if (share) return CallerOf(*share);
  }
  return std::nullopt;
}

}  // namespace

std::optional<Caller> CallerOfSecret(Connection& connection, const std::string& secret) {
  if (secret.starts_with(PrefixOf(SecretKind::kToken))) {
    if (const auto token = FindUsableToken(connection, HashOfSecret(secret)))
      return CallerOf(*token);
  } else if (secret.starts_with(PrefixOf(SecretKind::kShare))) {
    if (const auto share = FindUsableShare(connection, HashOfSecret(secret)))
      return CallerOf(*share);
  }
  return std::nullopt;
}

std::string BeginSession(Database& database, const Caller& caller) {
  const std::string secret = NewSecret(SecretKind::kSession);
  const std::string now = NowUtc();
  const std::optional<std::string> id = caller.id, nothing;
  database.Write([&](Connection& connection) {
    connection.Execute("DELETE FROM sessions WHERE expires_at < ? OR used_at < ?", now,
                       UtcIn(-kIdleTime));
    connection.Execute(
        "INSERT INTO sessions (secret_sha256, token, share, created_at, used_at, expires_at) "
        "VALUES (?, ?, ?, ?, ?, ?)",
        HashOfSecret(secret), caller.has_link_only ? nothing : id,
        caller.has_link_only ? id : nothing, now, now, UtcIn(kLifetime));
    RecordAudit(connection, "session.begin", caller.id);
  });
  return secret;
}

std::optional<Caller> CallerOfSession(Database& database, const std::string& secret) {
  const std::string hash = HashOfSecret(secret);
  std::string used_at;
  const std::optional<Caller> caller =
      database.Read([&](Connection& connection) -> std::optional<Caller> {
        const std::optional<Session> session = FindSession(connection, hash);
        if (!session) return std::nullopt;
        used_at = session->used_at;
        return CallerOfRow(connection, *session);
      });
  if (caller && used_at < UtcIn(-kNotedEvery) && !database.is_frozen())
    database.Write([&](Connection& connection) {
      connection.Execute("UPDATE sessions SET used_at = ? WHERE secret_sha256 = ?", NowUtc(), hash);
    });
  return caller;
}

void EndSession(Database& database, const std::string& secret) {
  database.Write([&](Connection& connection) {
    const int count =
        connection.Execute("DELETE FROM sessions WHERE secret_sha256 = ?", HashOfSecret(secret));
    if (count > 0) RecordAudit(connection, "session.end", CurrentCaller().id);
  });
}

std::string CsrfTokenOf(const std::string& session_secret) {
  return Sha256Of("csrf:" + session_secret);
}

}  // namespace parkade
