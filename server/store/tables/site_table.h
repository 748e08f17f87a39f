#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/store/tables/database.h"
#include "server/store/tables/records.h"
#include "server/store/tables/site_scope.h"

namespace parkade {

/// Inserts the site unless it exists.
void EnsureSite(Connection& connection, const std::string& name);

bool HasSite(Connection& connection, const std::string& name);

/// Stores title, note, days, default rig and checklist.
void SetSiteSettings(Connection& connection, const Site& site);

/// The rig of uploads to the site that name none; nothing where there is no site, either.
std::optional<std::string> DefaultRigOf(Connection& connection, const std::string& site);

/// `wanted`, or `wanted-2`, `wanted-3`, ... where that is taken.
std::string FreeSiteName(Connection& connection, const std::string& wanted);

/// Throws Error{kNotFound}.
Site FindSite(Connection& connection, const std::string& name);

/// Newest first, those in `scope`; only those whose latest version is in one of `states` where
/// there are any.
std::vector<Site> ListSites(Connection& connection, const Page& page, const SiteScope& scope = {},
                            const std::vector<ReviewState>& states = {});

}  // namespace parkade
