#pragma once

#include <httplib.h>

#include <optional>
#include <string>

#include "server/http/route_table.h"
#include "server/store/tables/database.h"

namespace parkade {

/// What a request's path names.
struct Subject {
  std::string what, id;             ///< "drive", "0123456789abcdef"
  std::optional<std::string> site;  ///< nothing: none yet
  std::string created_by;           ///< id of the token; empty where none was needed
};

/// Nothing where the path names nothing that belongs to a site, or nothing that exists.
std::optional<Subject> SubjectOf(const Route& route, const httplib::Request& request,
                                 Database& database);

/// The version of a map in the path, if any.
std::optional<std::int64_t> VersionOf(const Route& route, const httplib::Request& request);

}  // namespace parkade
