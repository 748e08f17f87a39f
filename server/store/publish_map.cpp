#include "server/store/publish_map.h"

#include <algorithm>

#include "core/error.h"
#include "core/files/sha256.h"
#include "core/log.h"
#include "server/store/access/audit_log.h"
#include "server/store/disk/durable_file.h"
#include "server/store/disk/file_sums.h"
#include "server/store/tables/drive_table.h"
#include "server/store/tables/job_table.h"
#include "server/store/tables/map_table.h"
#include "server/store/tables/names.h"
#include "server/store/tables/outbox.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxFiles = 250'000;

/// Lists, hashes and makes durable everything below `staging`, while `go_on` says so.
std::optional<std::vector<MapFile>> SealFiles(const fs::path& staging,
                                              const std::function<bool()>& go_on) {
  Require(fs::is_directory(fs::symlink_status(staging)), ErrorCode::kInternal,
          "the worker left no folder");
  std::vector<MapFile> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(staging)) {
    const std::string name = entry.path().lexically_relative(staging).generic_string();
    const fs::file_status status = entry.symlink_status();
    Require(IsPlainPath(name), ErrorCode::kInternal, "the worker left a file with an unusual name");
    Require(fs::is_regular_file(status) || fs::is_directory(status), ErrorCode::kInternal,
            "the worker left '" + name + "', which is neither a file nor a folder");
    SyncToDisk(entry.path());
    if (fs::is_directory(status)) continue;
    fs::permissions(entry.path(),
                    fs::perms::owner_read | fs::perms::group_read | fs::perms::others_read);
    Require(files.size() < kMaxFiles, ErrorCode::kInternal,
            "the worker left more than " + std::to_string(kMaxFiles) + " files");
    const std::optional<FileSums> sums = SumsOfFile(entry.path(), go_on);
    if (!sums) return std::nullopt;
    files.push_back({name, sums->bytes, sums->sha256, sums->pieces});
  }
  SyncToDisk(staging);
  std::sort(files.begin(), files.end(),
            [](const MapFile& a, const MapFile& b) { return a.name < b.name; });
  for (const std::string required : {"map.glb", "report.json"}) {
    const bool is_there = std::any_of(files.begin(), files.end(), [&](const MapFile& file) {
      return file.name == required && file.bytes > 0;
    });
    Require(is_there, ErrorCode::kInternal, "the worker ended without '" + required + "'");
  }
  return files;
}

std::string HashOfManifest(const std::vector<MapFile>& files) {
  Sha256 hash;
  for (const MapFile& file : files)
    hash.Add(file.sha256 + " " + std::to_string(file.bytes) + " " + file.name + "\n");
  return hash.Finish();
}

/// The transaction that makes `map` visible; its folder is in place. Sets the version and drives.
void InsertVersion(Store& store, const Job& job, const ReportSummary& report, MapVersion& map) {
  store.database.Write([&](Connection& connection) {
    map.version = NextMapVersion(connection, map.site);
    std::vector<Drive> left_out;
    for (const std::string& id : job.drives) {
      Drive drive = FindDriveOrTombstone(connection, id);
      (report.left_out.contains(drive.name) ? left_out : map.drives).push_back(std::move(drive));
    }
    Require(!map.drives.empty(), ErrorCode::kInternal,
            "the worker left all drives out and made a map");
    InsertMap(connection, map);
    RecordAudit(connection, "map.publish", map.site + "/" + std::to_string(map.version),
                "{\"job\":\"" + job.id + "\"}");
    const bool is_current = EndJob(connection, job.id, job.attempt,
                                   {JobState::kDone, std::nullopt, std::nullopt, map.version});
    Require(is_current, ErrorCode::kConflict,
            "attempt " + std::to_string(job.attempt) + " of job '" + job.id +
                "' is no longer the running one");
    NoteJobEnd(connection, FindJob(connection, job.id));
    for (const std::string& companion : EndCompanions(connection, job, map.version))
      NoteJobEnd(connection, FindJob(connection, companion));
    NotePublished(connection, map);
    for (const Drive& drive : map.drives) {
      SetDriveState(connection, drive.id, DriveState::kReady, std::nullopt);
      const auto streams = report.streams_of_drive.find(drive.name);
      if (streams != report.streams_of_drive.end())
        SetDriveStreams(connection, drive.id, streams->second);
    }
    for (const Drive& drive : left_out) {
      const std::string reason = "left out of version " + std::to_string(map.version) + ": " +
                                 report.left_out.at(drive.name);
      // A drive that already is in a map stays ready, whatever comes later.
      if (HasMap(connection, drive.id)) {
        SetDriveState(connection, drive.id, DriveState::kReady, std::nullopt);
      } else {
        SetDriveState(connection, drive.id, DriveState::kFailed, reason);
      }
    }
  });
}

}  // namespace

std::optional<SealedMap> SealMap(const fs::path& staging, const std::function<bool()>& go_on) {
  std::optional<std::vector<MapFile>> files = SealFiles(staging, go_on);
  if (!files) return std::nullopt;
  return SealedMap{staging, *std::move(files), ReadReportSummary(staging / "report.json")};
}

MapVersion PublishMap(Store& store, const Job& job, const SealedMap& sealed) {
  const ReportSummary& report = sealed.report;
  MapVersion map;
  map.id = NewId();
  map.site = job.site;
  map.job = job.id;
  map.files = sealed.files;
  map.sha256 = HashOfManifest(map.files);
  map.datum = report.datum;
  map.bounds = report.bounds;
  map.created_at = NowUtc();

  const fs::path folder = store.directory.MapFolder(map.id);
  fs::rename(sealed.staging, folder);
  try {
    SyncToDisk(folder.parent_path());
    InsertVersion(store, job, sealed.report, map);
  } catch (const DiskFailure&) {
    throw;  // the version may be there after the next start, and needs its folder then
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
    throw;
  }
  LogInfo("published site=" + map.site + " version=" + std::to_string(map.version) +
          " files=" + std::to_string(map.files.size()) + " job=" + job.id);
  return map;
}

}  // namespace parkade
