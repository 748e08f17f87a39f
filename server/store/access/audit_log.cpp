#include "server/store/access/audit_log.h"

#include <nlohmann/json.hpp>

#include "core/files/sha256.h"
#include "server/store/access/caller.h"
#include "server/store/tables/names.h"

namespace parkade {
namespace {

const std::string kSelect =
    "SELECT sequence, at, caller, caller_name, address, action, subject, detail, sha256 FROM "
    "audit ";

AuditEntry FromRow(const Statement& row) {
  AuditEntry entry;
  entry.sequence = row.Integer(0);
  entry.at = row.Text(1);
  entry.caller_id = row.Text(2);
  entry.caller_name = row.Text(3);
  entry.address = row.Text(4);
  entry.action = row.Text(5);
  entry.subject = row.Text(6);
  entry.detail = row.Text(7);
  entry.sha256 = row.Text(8);
  return entry;
}

/// JSON, so that no text can pass for the end of one field and the begin of the next.
std::string HashOf(const AuditEntry& entry, const std::string& before) {
  const nlohmann::json fields = {before,          entry.sequence,    entry.at,
                                 entry.caller_id, entry.caller_name, entry.address,
                                 entry.action,    entry.subject,     entry.detail};
  return Sha256Of(fields.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

}  // namespace

void RecordAudit(Connection& connection, const std::string& action, const std::string& subject,
                 const std::string& detail) {
  AuditEntry entry;
  std::string before;
  {
    Statement last =
        connection.Query("SELECT sequence, sha256 FROM audit ORDER BY sequence DESC LIMIT 1");
    if (last.Step()) {
      entry.sequence = last.Integer(0);
      before = last.Text(1);
    }
  }
  const Caller& caller = CurrentCaller();
  ++entry.sequence;
  entry.at = NowUtc();
  entry.caller_id = caller.id;
  entry.caller_name = caller.name;
  entry.address = caller.address;
  entry.action = action;
  entry.subject = subject;
  entry.detail = detail;
  connection.Execute(
      "INSERT INTO audit (sequence, at, caller, caller_name, address, action, subject, detail, "
      "sha256) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)",
      entry.sequence, entry.at, entry.caller_id, entry.caller_name, entry.address, entry.action,
      entry.subject, entry.detail, HashOf(entry, before));
}

std::vector<AuditEntry> ListAudit(Connection& connection, const Page& page) {
  Statement query = connection.Query(kSelect + "WHERE sequence < ? ORDER BY sequence DESC LIMIT ?",
                                     page.before, page.limit);
  std::vector<AuditEntry> entries;
  while (query.Step()) entries.push_back(FromRow(query));
  return entries;
}

std::optional<std::string> DamageOfAudit(Connection& connection) {
  Statement query = connection.Query(kSelect + "ORDER BY sequence");
  std::string before;
  std::int64_t count = 0;
  while (query.Step()) {
    const AuditEntry entry = FromRow(query);
    ++count;
    if (entry.sequence != count)
      return "entry " + std::to_string(count) + " of the audit log is missing";
    if (entry.sha256 != HashOf(entry, before))
      return "entry " + std::to_string(count) + " of the audit log was changed";
    before = entry.sha256;
  }
  // SQLite counts what it gave out: the last entries cannot be taken away unnoticed.
  Statement given = connection.Query("SELECT seq FROM sqlite_sequence WHERE name = 'audit'");
  if (given.Step() && given.Integer(0) != count)
    return "entry " + std::to_string(count + 1) + " of the audit log is missing";
  return std::nullopt;
}

}  // namespace parkade
