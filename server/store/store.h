#pragma once

#include <cstdint>
#include <filesystem>

#include "core/error.h"
#include "server/store/data_directory.h"
#include "server/store/disk/ballast.h"
#include "server/store/tables/database.h"

namespace parkade {

/// Everything a service keeps: files below one folder, and the database that
/// says what they are. A file without a row is nothing; a row without its file
/// does not happen, because the file is durable before the row is written.
struct Store {
  explicit Store(const std::filesystem::path& root)
      : directory(root),
        ballast(directory.root() / "db" / "ballast"),
        database(directory.DatabaseFile()) {}

  DataDirectory directory;
  Ballast ballast;
  Database database;
  /// [bytes] of the disk that uploads leave free for the database and the maps.
  std::int64_t disk_reserve = std::int64_t{2} << 30;
  /// Whether new drives wait for a first look at their logs.
  bool inspects_drives = false;
};

/// A Write that makes room, and so has to work on a full disk.
template <typename Body>
auto WriteToMakeRoom(Store& store, const Body& body) {
  try {
    return store.database.Write(body);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::kDiskFull || !store.ballast.Drop()) throw;
  }
  return store.database.Write(body);
}

/// Throws Error{kDiskFull} saying how much is needed and how much there is,
/// unless `bytes` fit on the disk beside the reserve.
void RequireSpace(const Store& store, std::int64_t bytes);

/// Moves what has no row in the database to quarantine/, finishes deletions
/// that were cut short and removes products of jobs that will not publish them.
/// Call at the start, before anything else uses the store.
void ReconcileFiles(Store& store);

}  // namespace parkade
