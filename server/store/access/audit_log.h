#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/store/tables/database.h"
#include "server/store/tables/records.h"

namespace parkade {

/// Who changed what, when. Entries are only ever added, and each one's hash covers the one before:
/// a changed, inserted or missing entry breaks the chain.
struct AuditEntry {
  std::int64_t sequence = 0;  ///< from 1, without gaps
  std::string at;
  std::string caller_id, caller_name, address;
  std::string action;   ///< "drive.delete"
  std::string subject;  ///< id or name of what was changed
  std::string detail;   ///< JSON; empty where there is nothing to add
  std::string sha256;   ///< of the hash before and all of the above
};

/// Says that the current caller does `action`. Call it in the transaction of the change.
void RecordAudit(Connection& connection, const std::string& action, const std::string& subject,
                 const std::string& detail = "");

/// Newest first.
std::vector<AuditEntry> ListAudit(Connection& connection, const Page& page);

/// Where the chain is broken, one sentence; nothing where it is whole.
std::optional<std::string> DamageOfAudit(Connection& connection);

}  // namespace parkade
