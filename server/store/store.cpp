#include "server/store/store.h"

#include <set>
#include <vector>

#include "core/error.h"
#include "server/store/disk/durable_file.h"
#include "server/store/tables/job_table.h"
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
            "SELECT count(*), count(*) FILTER (WHERE deleted_at IS NULL) FROM drives "
            "WHERE sha256 = ?",
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

/// Folders of attempts that may go on without a service.
std::set<fs::path> FoldersAtEngines(Store& store) {
  std::set<fs::path> folders;
  for (const Job& job : store.database.Read(RunningJobs))
    if (job.place && job.place->engine != kLocalEngine)
      folders.insert(store.directory.AttemptFolder(job.id, job.attempt));
  return folders;
}

void ReconcileJobFolders(Store& store) {
  const std::set<fs::path> in_use = FoldersAtEngines(store);
  for (const fs::path& folder : FoldersOf(store, store.directory.JobsFolder())) {
    if (!HasRow(store, "jobs", folder.filename().string())) {
      store.directory.PutAside(folder);
      continue;
    }
    for (const fs::path& attempt : EntriesOf(folder)) {
      if (in_use.contains(attempt)) continue;
      fs::remove_all(attempt / "out");
      fs::remove_all(attempt / "input");
      fs::remove_all(attempt / "tmp");
      fs::remove_all(attempt / "runs");
      fs::remove(attempt / "preview.glb");
    }
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
  for (const fs::path& folder : FoldersOf(store, store.directory.MapsFolder()))
    if (!HasRow(store, "maps", folder.filename().string())) store.directory.PutAside(folder);
  for (const fs::path& folder : FoldersOf(store, store.directory.RigsFolder()))
    if (!HasRow(store, "rigs", folder.filename().string())) store.directory.PutAside(folder);
}

}  // namespace parkade
