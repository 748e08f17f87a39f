#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "server/jobs/job_runner.h"
#include "server/store/tables/records.h"
#include "server/store/tables/upload_set_table.h"
#include "server/store/tables/upload_table.h"

namespace parkade {

using Json = nlohmann::ordered_json;

/// The value, null where there is none.
template <typename Value>
Json OrNull(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}

// Rows as the API shows them (openapi.json, components/schemas).

/// The drive without what needs more than its row: see AddTrajectories.
Json ToJson(const Drive& drive);
Json ToJson(const Upload& upload);
/// `job`: of the drive that the set became.
Json ToJson(const UploadSet& set, const std::vector<Upload>& parts,
            const std::optional<std::string>& job);
Json ToJson(const Job& job, const std::optional<JobProgress>& progress);
Json ToJson(const StoredRig& rig);
Json ToJson(const Site& site);

/// `with_files`: the map has its files and drives (FindMap), not only its row.
Json ToJson(const MapVersion& map, bool with_files);

/// Adds links to the trajectories that `map`, the latest one of `drive`, has of it.
void AddTrajectories(const Drive& drive, const MapVersion& map, Json& json);

/// "/api/v1/sites/NAME/maps/VERSION"
std::string MapAddress(const std::string& site, std::int64_t version);

/// The content type, by the extension of a map file's name.
const char* ContentTypeOf(const std::string& filename);

}  // namespace parkade
