#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/store/access/caller.h"
#include "server/store/tables/database.h"
#include "server/store/tables/records.h"

namespace parkade {

/// A link that lets whoever has it see the maps of one site, until it ends.
struct Share {
  std::int64_t sequence = 0;
  std::string id;
  std::string name;  ///< for people: whom it was given to
  std::string site;
  std::optional<std::int64_t> version;  ///< the only one it leads to; nothing: all
  std::string created_by;               ///< name of the caller that made it
  std::string created_at, expires_at;
  std::optional<std::string> revoked_at;
};

struct NewShare {
  Share share;
  std::string secret;
};

/// Makes a link with the name, site, version and end of `wanted`. Throws Error{kInvalidInput} for
/// an unusable name or end, Error{kNotFound} where there is no such site or version.
NewShare CreateShare(Database& database, const Share& wanted);

/// Throws Error{kNotFound}, Error{kConflict} for one that was revoked before.
void RevokeShare(Database& database, const std::string& id);

/// Newest first, those of sites in `scope`, those that are over as well.
std::vector<Share> ListShares(Connection& connection, const Page& page, const SiteScope& scope);

/// One that is not over, by what its secret was stored as.
std::optional<Share> FindUsableShare(Connection& connection, const std::string& secret_hash);
std::optional<Share> FindUsableShareById(Connection& connection, const std::string& id);

Caller CallerOf(const Share& share);

}  // namespace parkade
