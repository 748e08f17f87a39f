#include "server/store/store.h"

#include <algorithm>
#include <chrono>
#include <set>
#include <unordered_set>
#include <vector>

#include "core/error.h"
#include "server/store/disk/durable_file.h"
#include "server/store/tables/job_table.h"
#include "server/store/tables/upload_set_table.h"
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
  std::vector<fs::path> others;
  // An entry knows its kind from the list of the folder: nothing else is read for thousands of
  // them.
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    (entry.is_directory() && !entry.is_symlink() ? folders : others).push_back(entry.path());
  for (const fs::path& other : others) store.directory.PutAside(other);
  return folders;
}

/// The first column of what the query finds.
template <typename... Values>
std::unordered_set<std::string> TextsOf(Store& store, const char* sql, const Values&... values) {
  return store.database.Read([&](Connection& connection) {
    Statement query = connection.Query(sql, values...);
    std::unordered_set<std::string> texts;
    while (query.Step()) texts.insert(query.Text(0));
    return texts;
  });
}

/// Puts folders aside that no row knows.
void ReconcileFolders(Store& store, const fs::path& folder, const char* sql_of_ids) {
  const std::unordered_set<std::string> known = TextsOf(store, sql_of_ids);
  for (const fs::path& one : FoldersOf(store, folder))
    if (!known.contains(one.filename().string())) store.directory.PutAside(one);
}

bool HasRow(Store& store, const char* table, const std::string& id) {
  return store.database.Read([&](Connection& connection) {
    return connection.Query(std::string("SELECT 1 FROM ") + table + " WHERE id = ?", id).Step();
  });
}

void ReconcileLogs(Store& store) {
  const std::unordered_set<std::string> known = TextsOf(store, "SELECT sha256 FROM drives");
  const std::unordered_set<std::string> wanted = TextsOf(
      store, "SELECT sha256 FROM drives WHERE deleted_at IS NULL AND log_deleted_at IS NULL");
  for (const fs::path& folder : FoldersOf(store, store.directory.LogsFolder())) {
    for (const fs::path& log : EntriesOf(folder)) {
      const std::string sha256 = log.filename().string();
      if (wanted.contains(sha256)) continue;
      if (known.contains(sha256)) {
        fs::remove(log);
      } else {
        store.directory.PutAside(log);
      }
    }
  }
}

void ReconcileUploads(Store& store) {
  std::set<std::string> unfinished;
  for (const Upload& upload : store.database.Read(UnfinishedUploads)) unfinished.insert(upload.id);
  for (const UploadSet& set : store.database.Read(UnfinishedUploadSets)) unfinished.insert(set.id);
  for (const fs::path& file : EntriesOf(store.directory.UploadsFolder())) {
    const std::string id = file.filename().string();
    if (unfinished.contains(id)) continue;
    if (HasRow(store, "uploads", id) || HasRow(store, "upload_sets", id)) {
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

/// Removes what attempts leave behind that were not ended by the service. Jobs that had ended when
/// an earlier service did this have nothing to remove.
void ReconcileAttempts(Store& store) {
  const std::set<fs::path> in_use = FoldersAtEngines(store);
  for (const std::string& job :
       TextsOf(store, "SELECT id FROM jobs WHERE finished_at IS NULL OR finished_at >= ?",
               store.directory.ReconciledUntil())) {
    const fs::path folder = store.directory.JobFolder(job);
    if (!fs::exists(folder)) continue;
    for (const fs::path& attempt : EntriesOf(folder)) {
      if (in_use.contains(attempt) || attempt == store.directory.WorkerFolder(job)) continue;
      for (const char* part : {"input", "out", "runs"}) fs::remove_all(attempt / part);
    }
    const bool is_in_use = std::any_of(in_use.begin(), in_use.end(), [&](const fs::path& attempt) {
      return attempt.parent_path() == folder;
    });
    if (!is_in_use) store.directory.RemoveLeftovers(job);
  }
}

/// Finishes what the retention was about to delete: such a version has its row still.
void ReconcileMaps(Store& store) {
  for (const std::string& id :
       TextsOf(store, "SELECT id FROM maps WHERE files_deleted_at IS NOT NULL"))
    fs::remove_all(store.directory.MapFolder(id));
  ReconcileFolders(store, store.directory.MapsFolder(), "SELECT id FROM maps");
}

}  // namespace

void RequireSpace(const Store& store, std::int64_t bytes) {
  const std::int64_t available = FreeBytes(store.directory.root()) - store.disk_reserve;
  Require(bytes <= available, ErrorCode::kDiskFull,
          "the disk is full: " + std::to_string(bytes) + " bytes are needed and " +
              std::to_string(std::max<std::int64_t>(available, 0)) + " are available");
}

void ReconcileFiles(Store& store) {
  const auto now = std::chrono::system_clock::now();
  ReconcileUploads(store);
  ReconcileLogs(store);
  ReconcileFolders(store, store.directory.JobsFolder(), "SELECT id FROM jobs");
  ReconcileAttempts(store);
  ReconcileMaps(store);
  ReconcileFolders(store, store.directory.RigsFolder(), "SELECT id FROM rigs");
  store.directory.NoteReconciled(now);
}

}  // namespace parkade
