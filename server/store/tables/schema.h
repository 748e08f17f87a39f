#pragma once

#include "server/store/tables/connection.h"

namespace parkade {

/// Brings the tables to the version this program knows, inside the caller's
/// transaction. Throws Error{kConflict} when a newer program wrote them.
void MigrateSchema(Connection& connection);

/// Throws Error{kConflict} unless the tables are of the version this program knows.
void RequireSchema(Connection& connection);

}  // namespace parkade
