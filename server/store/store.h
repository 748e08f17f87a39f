#pragma once

#include <cstdint>
#include <filesystem>

#include "server/store/data_directory.h"
#include "server/store/tables/database.h"

namespace parkade {

/// Everything a service keeps: files below one folder, and the database that
/// says what they are. A file without a row is nothing; a row without its file
/// does not happen, because the file is durable before the row is written.
struct Store {
  explicit Store(const std::filesystem::path& root)
      : directory(root), database(directory.DatabaseFile()) {}

  DataDirectory directory;
  Database database;
  /// [bytes] of the disk that uploads leave free for the database and the maps.
  std::int64_t disk_reserve = std::int64_t{2} << 30;
};

/// Throws Error{kDiskFull} saying how much is needed and how much there is,
/// unless `bytes` fit on the disk beside the reserve.
void RequireSpace(const Store& store, std::int64_t bytes);

/// Moves what has no row in the database to quarantine/, finishes deletions
/// that were cut short and removes products of jobs that will not publish them.
/// Call at the start, before anything else uses the store.
void ReconcileFiles(Store& store);

}  // namespace parkade
