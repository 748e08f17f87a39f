#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/store/access/caller.h"
#include "server/store/tables/database.h"
#include "server/store/tables/records.h"

namespace parkade {

/// What lets a program or a person in. Its secret is shown once, when it is made.
struct Token {
  std::int64_t sequence = 0;
  std::string id;
  std::string name;  ///< for people
  Role role = Role::kViewer;
  SiteScope sites;
  bool may_see_pictures = false;
  std::string created_at;
  std::optional<std::string> expires_at, revoked_at;
  std::optional<std::string> used_at;  ///< to the hour
};

struct NewToken {
  Token token;
  std::string secret;
};

/// Makes a token with the name, role, sites, right and end of `wanted`. Throws Error{kInvalidInput}
/// for an unusable name, site or end, Error{kUsage} where it is the first one and not an admin's
/// for all sites: nobody could make another.
NewToken CreateToken(Database& database, const Token& wanted);

/// From now on it lets nobody in. Throws Error{kNotFound}, Error{kConflict} for one that was
/// revoked before.
void RevokeToken(Database& database, const std::string& id);

/// Newest first, those that are over as well.
std::vector<Token> ListTokens(Connection& connection, const Page& page);

/// True once a token was made: from then on nobody gets in without one.
bool HasTokens(Connection& connection);

/// True when there is one that lets an admin of all sites in.
bool HasUsableAdmin(Connection& connection);

/// One that is not over, by what its secret was stored as.
std::optional<Token> FindUsableToken(Connection& connection, const std::string& secret_hash);
std::optional<Token> FindUsableTokenById(Connection& connection, const std::string& id);
void SetTokenUsed(Connection& connection, const std::string& id, const std::string& at);

Caller CallerOf(const Token& token);

/// Whoever began what is now finished without being asked: the one with the token `id`, whether it
/// is usable or over by now; the service where nobody needed a token.
Caller MakerOf(Connection& connection, const std::optional<std::string>& id);

}  // namespace parkade
