#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "server/store/report_summary.h"
#include "server/store/store.h"
#include "server/store/tables/records.h"

namespace parkade {

/// The products of a finished attempt, fit to be published.
struct SealedMap {
  std::filesystem::path staging;
  std::vector<MapFile> files;  ///< sorted by name
  ReportSummary report;
};

/// Hashes every file in `staging`, makes it durable and read-only: up to a minute for a large map.
/// Nothing where `go_on`, asked at each megabyte, says no. Throws Error{kInternal} when the
/// products are not a map or hold links or odd names, Error{kDiskFull}.
std::optional<SealedMap> SealMap(
    const std::filesystem::path& staging, const std::function<bool()>& go_on = [] { return true; });

/// Makes a sealed map the next version of its site and ends the job: the folder is renamed into the
/// store, and one transaction makes it visible. Readers see the old state or the new one. Throws
/// Error{kConflict} when the attempt is no longer the running one, Error{kInternal} when the worker
/// left all drives out, Error{kDiskFull}; nothing is published then, and what was staged is gone or
/// still where it was.
MapVersion PublishMap(Store& store, const Job& job, const SealedMap& sealed);

}  // namespace parkade
