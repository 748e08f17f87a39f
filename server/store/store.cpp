#include "server/store/store.h"

#include <set>
#include <vector>

#include "core/error.h"
#include "server/store/disk/durable_file.h"
#include "server/store/tables/upload_table.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> EntriesOf(const fs::path& folder) {
  std::vector<fs::path> entries;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    entries.push_back(entry.path());
  return entries;
}

/// The folders in `folder`; anything else there is not ours.
std::vector<fs::path> FoldersOf(const Store& store, const fs::path& folder) {
  std::vector<fs::path> folders;
  for (const fs::path& entry : EntriesOf(folder)) {
    if (fs::is_directory(fs::symlink_status(entry))) {
      folders.push_back(entry);
    } else {
      store.directory.PutAside(entry);
    }
  }
  return folders;
}

bool HasRow(Store& store, const char* table, const std::string& id) {
  return store.database.Read([&](Connection& connection) {
    return connection.Query(std::string("SELECT 1 FROM ") + table + " WHERE id = ?", id).Step();
  });
}

void ReconcileLogs(Store& store) {
  for (const fs::path& folder : FoldersOf(store, store.directory.LogsFolder())) {
    for (const fs::path& log : EntriesOf(folder)) {
      const auto [rows, live_rows] = store.database.Read([&](Connection& connection) {
        Statement query = connection.Query(
            "SELECT count(*), count(*) FILTER (WHERE deleted_at IS NULL AND log_deleted_at IS "
            "NULL) "
            "FROM drives WHERE sha256 = ?",
            log.filename().string());
        query.Step();
        return std::pair(query.Integer(0), query.Integer(1));
      });
      if (rows == 0) store.directory.PutAside(log);
      if (rows > 0 && live_rows == 0) fs::remove(log);
    }
  }
}

void ReconcileUploads(Store& store) {
  std::set<std::string> unfinished;
  for (const Upload& upload : store.database.Read(UnfinishedUploads)) unfinished.insert(upload.id);
  for (const fs::path& file : EntriesOf(store.directory.UploadsFolder())) {
    const std::string id = file.filename().string();
    if (unfinished.contains(id)) continue;
    if (HasRow(store, "uploads", id)) {
      fs::remove(file);
    } else {
      store.directory.PutAside(file);
    }
  }
}

void ReconcileJobFolders(Store& store) {
  for (const fs::path& folder : FoldersOf(store, store.directory.JobsFolder())) {
    if (!HasRow(store, "jobs", folder.filename().string())) {
      store.directory.PutAside(folder);
      continue;
    }
    for (const fs::path& attempt : EntriesOf(folder)) {
      fs::remove_all(attempt / "out");
      fs::remove_all(attempt / "input");
      fs::remove_all(attempt / "tmp");
      fs::remove(attempt / "preview.glb");
    }
  }
}

/// A version whose files the retention was about to delete has its row still.
void ReconcileMaps(Store& store) {
  for (const fs::path& folder : FoldersOf(store, store.directory.MapsFolder())) {
    const std::string id = folder.filename().string();
    const auto [has_row, has_files] = store.database.Read([&](Connection& connection) {
      Statement query =
          connection.Query("SELECT files_deleted_at IS NULL FROM maps WHERE id = ?", id);
      const bool found = query.Step();
      return std::pair(found, found && query.Integer(0) != 0);
    });
    if (!has_row) store.directory.PutAside(folder);
    if (has_row && !has_files) fs::remove_all(folder);
  }
}

}  // namespace

void RequireSpace(const Store& store, std::int64_t bytes) {
  const std::int64_t available = FreeBytes(store.directory.root()) - store.disk_reserve;
  Require(bytes <= available, ErrorCode::kDiskFull,
          "the disk is full: " + std::to_string(bytes) + " bytes are needed and " +
              std::to_string(std::max<std::int64_t>(available, 0)) + " are available");
}

void ReconcileFiles(Store& store) {
  ReconcileUploads(store);
  ReconcileLogs(store);
  ReconcileJobFolders(store);
  ReconcileMaps(store);
  for (const fs::path& folder : FoldersOf(store, store.directory.RigsFolder()))
    if (!HasRow(store, "rigs", folder.filename().string())) store.directory.PutAside(folder);
}

}  // namespace parkade
