#pragma once

#include <optional>
#include <string>

#include "server/store/access/caller.h"
#include "server/store/tables/database.h"

namespace parkade {

/// The caller whose token or share link `secret` is; nothing where it lets nobody in.
std::optional<Caller> CallerOfSecret(Connection& connection, const std::string& secret);

// A browser's session. It ends 12 hours after it began, an hour after it was last used, and with
// the token or link it began with.

/// Begins a session of the caller, who came with a token or a link. Returns its secret.
std::string BeginSession(Database& database, const Caller& caller);

/// The caller of a session that is not over; notes that it was used.
std::optional<Caller> CallerOfSession(Database& database, const std::string& secret);

void EndSession(Database& database, const std::string& secret);

/// What pages have to send with changes: it can be told from a session's secret, which no page
/// sees.
std::string CsrfTokenOf(const std::string& session_secret);

}  // namespace parkade
