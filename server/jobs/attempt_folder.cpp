#include "server/jobs/attempt_folder.h"

#include <system_error>

#include "core/error.h"
#include "server/store/disk/workers_files.h"
#include "server/store/job_queue.h"
#include "server/store/job_work.h"
#include "server/store/tables/drive_table.h"
#include "server/store/tables/map_table.h"
#include "server/store/tables/rig_table.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

std::vector<Drive> DrivesOf(Store& store, const Job& job) {
  Require(!job.drives.empty(), ErrorCode::kInvalidInput, "all drives of this job were deleted");
  return store.database.Read([&](Connection& connection) {
    std::vector<Drive> drives;
    for (const std::string& id : job.drives) drives.push_back(FindDrive(connection, id));
    return drives;
  });
}

/// The rig's folder; empty where the drive names no rig.
fs::path RigFolderOf(Store& store, const Drive& drive) {
  if (!drive.rig) return {};
  const std::optional<StoredRig> rig =
      store.database.Read([&](Connection& connection) { return FindRig(connection, *drive.rig); });
  Require(rig.has_value(), ErrorCode::kNotFound, "there is no rig '" + *drive.rig + "'");
  return store.directory.RigFolder(rig->id);
}

/// The map to start from: the version that a review names. A job of several drives takes the site's
/// latest, so that its work grows with what is new. Published maps never change, and
/// none of a site is deleted while a job of it runs (DeleteExpired): the worker may read there.
std::optional<fs::path> MapToStartFrom(Store& store, const Job& job) {
  return store.database.Read([&](Connection& connection) -> std::optional<fs::path> {
    std::int64_t version = job.review.from_version.value_or(0);
    if (version == 0 && job.drives.size() > 1) version = NextMapVersion(connection, job.site) - 1;
    if (version == 0) return std::nullopt;
    return store.directory.MapFolder(FindMap(connection, job.site, version).id);
  });
}

}  // namespace

AttemptFolder::AttemptFolder(Store& store, const Job& job)
    : store_(store),
      data_(store.directory.root()),
      path_(store.directory.AttemptFolder(job.id, job.attempt)) {
  const std::vector<Drive> drives = DrivesOf(store, job);
  spec_.job = job.id;
  spec_.attempt = job.attempt;
  for (const Drive& drive : drives) spec_.rigs.push_back(RigFolderOf(store, drive));
  spec_.from = MapToStartFrom(store, job);
  spec_.rejected_loops = job.review.rejected_loops;
  spec_.forced_loops = job.review.forced_loops;
  spec_.rejected_links = job.review.rejected_links;
  spec_.forced_links = job.review.forced_links;
  spec_.pins = job.review.pins;
  spec_.work = store.directory.WorkFolder(job.id);
  spec_.out = RunFolder() / "out";
  spec_.progress = RunFolder() / "progress.ndjson";
  spec_.preview = store.directory.PreviewFile(job.id, job.attempt);
  try {
    if (!job.place) Begin(job);
    fs::create_directories(path_ / "input");
    // Hard links: deleting the drive meanwhile takes nothing from the worker.
    for (const Drive& drive : drives) {
      spec_.logs.push_back(path_ / "input" / drive.name);
      if (fs::exists(spec_.logs.back())) continue;
      fs::create_hard_link(store.directory.LogFile(drive.sha256), spec_.logs.back());
    }
  } catch (const fs::filesystem_error& error) {
    const bool is_full = error.code() == std::errc::no_space_on_device;
    throw Error(
        is_full ? ErrorCode::kDiskFull : ErrorCode::kInternal,
        is_full ? "the disk of the data directory is full" : "the job's folder cannot be made");
  }
}

/// An earlier attempt's worker may have left anything under the names that this one uses.
void AttemptFolder::Begin(const Job& job) {
  store_.directory.RemoveLeftovers(job.id);
  // Twice it crashed: that may lie in what was kept, and the last try begins anew.
  if (job.crashes + 1 >= kMaxCrashes) DropWork(store_, job.id);
  fs::create_directories(spec_.work);
  for (const fs::path& folder : {RunFolder(), spec_.out, TemporaryFiles()})
    Require(fs::create_directory(folder), ErrorCode::kInternal,
            "the folder of an earlier attempt cannot be removed");
}

bool AttemptFolder::HasProducts(const fs::path& products) const {
  return fs::exists(fs::symlink_status(products)) || fs::exists(path_ / "out");
}

fs::path AttemptFolder::TakeProducts(const fs::path& products) const {
  fs::path taken = path_ / "out";
  // An earlier service may have come so far.
  if (!fs::exists(taken)) TakeWorkersFolder(products, taken);
  return taken;
}

AttemptFolder::~AttemptFolder() {
  if (is_kept_) return;
  std::error_code ignored;
  for (const char* part : {"input", "out", "runs"}) fs::remove_all(path_ / part, ignored);
  store_.directory.RemoveLeftovers(spec_.job);
  fs::remove(WorkerFolder(), ignored);  // where nothing was kept
}

}  // namespace parkade
