#include "server/store/receive_upload.h"

#include <algorithm>

#include "core/error.h"
#include "server/store/access/audit_log.h"
#include "server/store/access/caller.h"
#include "server/store/disk/durable_file.h"
#include "server/store/job_work.h"
#include "server/store/tables/check_table.h"
#include "server/store/tables/drive_table.h"
#include "server/store/tables/job_table.h"
#include "server/store/tables/names.h"
#include "server/store/tables/rig_table.h"
#include "server/store/tables/site_table.h"

namespace parkade {
namespace {

constexpr size_t kMaxFilenameLength = 255;

bool HasControlByte(const std::string& text) {
  return std::any_of(text.begin(), text.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 || byte == 0x7f;
  });
}

void RequirePlainName(const std::string& name, const char* what) {
  Require(IsPlainName(name), ErrorCode::kInvalidInput,
          std::string("the name of a ") + what +
              " is 1 to 64 letters, digits, dots, dashes or underscores, and starts with a letter "
              "or digit");
}

Job QueueFirstJob(Connection& connection, const Drive& drive, bool merge_drives) {
  Job job;
  job.id = NewId();
  job.site = drive.site;
  job.created_at = drive.created_at;
  job.drives = {drive.id};
  if (merge_drives) job.new_drive = drive.id;
  InsertJob(connection, job);
  return FindJob(connection, job.id);
}

}  // namespace

// Nothing else is done with the database meanwhile, so that no equal log arrives between check and
// removal. It is a Read, because it has to work on a full disk.
void RemoveUnusedLog(Store& store, const std::string& sha256) {
  store.database.Read([&](Connection& connection) {
    if (CountDrivesWithContent(connection, sha256) == 0)
      std::filesystem::remove(store.directory.LogFile(sha256));
  });
}

void CheckNewDrive(Store& store, const NewDrive& drive) {
  Require(drive.filename.size() <= kMaxFilenameLength && !HasControlByte(drive.filename),
          ErrorCode::kInvalidInput, "'filename' is at most 255 bytes without control characters");
  if (drive.site) RequirePlainName(*drive.site, "site");
  if (!drive.rig) return;
  RequirePlainName(*drive.rig, "rig");
  const bool has_rig = store.database.Read(
      [&](Connection& connection) { return FindRig(connection, *drive.rig).has_value(); });
  Require(has_rig, ErrorCode::kInvalidInput,
          "there is no rig '" + *drive.rig + "': PUT /api/v1/rigs/" + *drive.rig);
}

ReceivedDrive ReceiveDrive(Store& store, const NewDrive& new_drive, const ArrivedLog& log,
                           bool merge_drives,
                           const std::function<void(Connection&, const Drive&)>& also) {
  Drive drive;
  drive.id = NewId();
  drive.name = PlainNameFromFilename(new_drive.filename);
  drive.filename = new_drive.filename;
  drive.rig = new_drive.rig;
  drive.state = DriveState::kQueued;
  drive.bytes = log.bytes;
  drive.sha256 = log.sha256;
  if (store.inspects_drives) drive.inspection_state = kWaiting;
  drive.created_by = IdOfCurrentCaller();
  drive.created_at = drive.updated_at = NowUtc();

  const std::filesystem::path target = store.directory.LogFile(log.sha256);
  bool is_kept = false;
  try {
    return store.database.Write([&](Connection& connection) {
      drive.site = new_drive.site ? *new_drive.site : FreeSiteName(connection, drive.name);
      drive.name = FreeDriveName(connection, drive.site, drive.name);
      // This happens inside the transaction, so that no deletion of an equal log comes between.
      // What was just hashed takes the place of what lies there, which may have rotted.
      is_kept = true;
      KeepFile(log.path, target);
      SetFileCheck(connection, DataDirectory::LogPath(log.sha256), std::nullopt);
      EnsureSite(connection, drive.site);
      if (!drive.rig) drive.rig = DefaultRigOf(connection, drive.site);
      InsertDrive(connection, drive);
      const Job job = QueueFirstJob(connection, drive, merge_drives);
      also(connection, drive);
      RecordAudit(connection, "drive.create", drive.id, "{\"site\":\"" + drive.site + "\"}");
      return ReceivedDrive{FindDrive(connection, drive.id), job};
    });
  } catch (const DiskFailure&) {
    throw;  // the drive may be there after the next start, and needs its log then
  } catch (...) {
    if (is_kept) RemoveUnusedLog(store, log.sha256);
    throw;
  }
}

void DeleteDrive(Store& store, const std::string& id) {
  const std::string sha256 = WriteToMakeRoom(store, [&](Connection& connection) {
    const Drive drive = FindDrive(connection, id);
    const bool is_waiting =
        drive.state == DriveState::kQueued || drive.state == DriveState::kProcessing;
    std::optional<std::string> user = RunningJobOf(connection, id);
    if (!user && is_waiting) user = drive.job.value_or("");
    Require(
        !user, ErrorCode::kConflict,
        "drive '" + id + "' is in use by job '" + user.value_or("") + "': cancel the job first");
    MarkDriveDeleted(connection, id);
    RecordAudit(connection, "drive.delete", id, "{\"site\":\"" + drive.site + "\"}");
    if (CountDrivesWithContent(connection, drive.sha256) == 0)
      DropFileCheck(connection, DataDirectory::LogPath(drive.sha256));
    return drive.sha256;
  });
  // Files go after the commit: the other way round, a failed commit would leave a drive without its
  // log.
  RemoveUnusedLog(store, sha256);
  std::error_code ignored;  // the next start deletes what is left
  std::filesystem::remove_all(store.directory.PicturesFolder() / id, ignored);
  DropWorkOfDrive(store, id);
  store.ballast.Restore();
}

}  // namespace parkade
