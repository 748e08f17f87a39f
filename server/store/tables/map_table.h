#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/store/tables/database.h"
#include "server/store/tables/records.h"
#include "server/store/tables/site_scope.h"

namespace parkade {

/// The number the next version of a site gets; versions count from 1.
std::int64_t NextMapVersion(Connection& connection, const std::string& site);

/// Inserts the version with its files and drives.
void InsertMap(Connection& connection, const MapVersion& map);

/// Throw Error{kNotFound}. A row comes without files and drives.
MapVersion FindMapRow(Connection& connection, const std::string& site, std::int64_t version);
MapVersion FindMap(Connection& connection, const std::string& site, std::int64_t version);
std::int64_t LatestMapVersion(Connection& connection, const std::string& site);
std::int64_t ApprovedMapVersion(Connection& connection, const std::string& site);

/// Throws Error{kConflict} saying so where the version's files were deleted.
void RequireFiles(const MapVersion& map);

/// The version stays without its files.
void MarkFilesDeleted(Connection& connection, const std::string& id, const std::string& now);

/// Newest first, without files and drives.
std::vector<MapVersion> ListMaps(Connection& connection, const std::string& site, const Page& page);

/// Versions of all sites in `scope`, newest first, without files and drives; only those in one of
/// `states` where there are any.
std::vector<MapVersion> ListAllMaps(Connection& connection, const Page& page,
                                    const SiteScope& scope, const std::vector<ReviewState>& states);

/// One file of a published map.
struct PublishedFile {
  std::string map_id;
  MapFile file;
};

/// With the sums of its pieces, which whole versions come without. Throws Error{kNotFound}.
PublishedFile FindMapFile(Connection& connection, const std::string& site, std::int64_t version,
                          const std::string& name);

}  // namespace parkade
