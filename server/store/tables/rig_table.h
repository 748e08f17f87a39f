#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/store/tables/database.h"
#include "server/store/tables/records.h"

namespace parkade {

// Rows of `rigs`: one per revision; the newest of a name is the rig, older ones
// stay because jobs that run may still read them.

void InsertRig(Connection& connection, const StoredRig& rig);

std::optional<StoredRig> FindRig(Connection& connection, const std::string& name);

/// The newest revision of each name, newest first.
std::vector<StoredRig> ListRigs(Connection& connection, const Page& page);

}  // namespace parkade
