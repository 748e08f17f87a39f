#include "server/store/job_queue.h"

#include <algorithm>

#include "core/error.h"
#include "server/store/access/audit_log.h"
#include "server/store/tables/drive_table.h"
#include "server/store/tables/job_table.h"
#include "server/store/tables/map_table.h"
#include "server/store/tables/names.h"
#include "server/store/tables/outbox.h"
#include "server/store/tables/site_table.h"

namespace parkade {
namespace {

/// Drives in a map are ready, whatever comes later.
void SetStates(Connection& connection, const Job& job, DriveState state,
               const std::optional<std::string>& error = std::nullopt) {
  const std::vector<std::string> moved = job.new_drive ? std::vector{*job.new_drive} : job.drives;
  for (const std::string& drive : moved) {
    if (HasMap(connection, drive)) {
      SetDriveState(connection, drive, DriveState::kReady, std::nullopt);
    } else {
      SetDriveState(connection, drive, state, error);
    }
  }
}

/// Resets the drives of a job that waits again.
void ResetDrives(Connection& connection, const Job& job) {
  if (job.new_drive) SetJobDrives(connection, job.id, {*job.new_drive});
  DropDeletedDrives(connection, job.id);
}

void Requeue(Store& store, const Job& job, Setback setback, const std::string& reason,
             const std::optional<std::string>& not_before = std::nullopt) {
  store.database.Write([&](Connection& connection) {
    if (!RequeueJob(connection, job.id, job.attempt, setback, reason, not_before)) return;
    ResetDrives(connection, job);
    SetStates(connection, job, DriveState::kQueued);
  });
}

/// What failed may be the fault of a neighbor: the job is tried again without any.
bool GoAlone(Connection& connection, const Job& job, const std::string& sentence) {
  if (!RequeueJob(connection, job.id, job.attempt, Setback::kCrash, sentence, std::nullopt))
    return false;
  ResetDrives(connection, job);
  SetStates(connection, job, DriveState::kQueued);
  return true;
}

/// The job has ended, and with it what its drives wait for.
void FinishJob(Connection& connection, const Job& job, DriveState state,
               const std::optional<std::string>& error = std::nullopt) {
  SetStates(connection, job, state, error);
  NoteJobEnd(connection, FindJob(connection, job.id));
}

/// Throws where what the job would read was deleted by the retention of its site.
void RequireInputs(Connection& connection, const Job& job) {
  if (job.review.from_version)
    RequireFiles(FindMapRow(connection, job.site, *job.review.from_version));
  for (const std::string& drive : job.drives) RequireLog(FindDrive(connection, drive));
}

/// `named`, which have to be among the drives of a version, or else all of these that were not
/// deleted meanwhile.
std::vector<std::string> DrivesOfReview(Connection& connection, const std::string& site,
                                        std::int64_t version, std::vector<std::string> named) {
  const MapVersion map = FindMap(connection, site, version);
  RequireFiles(map);
  std::vector<std::string> of_version;
  for (const Drive& drive : map.drives) of_version.push_back(drive.id);
  for (const std::string& drive : named)
    Require(std::count(of_version.begin(), of_version.end(), drive) == 1, ErrorCode::kInvalidInput,
            "drive '" + drive + "' is not in version " + std::to_string(version));
  if (!named.empty()) return named;
  const std::vector<std::string> of_site = DrivesOfSite(connection, site);
  for (const Drive& drive : map.drives) {
    RequireLog(drive);
    if (std::count(of_site.begin(), of_site.end(), drive.id) == 1) named.push_back(drive.id);
  }
  Require(!named.empty(), ErrorCode::kConflict,
          "all drives of version " + std::to_string(version) + " were deleted");
  return named;
}

}  // namespace

Job QueueMap(Store& store, const std::string& site, std::vector<std::string> drives,
             bool merge_drives, const MapReview& review) {
  return store.database.Write([&](Connection& connection) {
    Require(HasSite(connection, site), ErrorCode::kNotFound, "there is no site '" + site + "'");
    if (review.from_version)
      drives = DrivesOfReview(connection, site, *review.from_version, std::move(drives));
    if (drives.empty()) drives = DrivesOfSite(connection, site);
    Require(!drives.empty(), ErrorCode::kInvalidInput,
            "site '" + site + "' has no drives whose logs are stored");
    Require(merge_drives || drives.size() == 1, ErrorCode::kInvalidInput,
            "this service maps one drive at a time: name one of the " +
                std::to_string(drives.size()) + " drives of site '" + site + "' in \"drives\"");
    for (size_t i = 0; i < drives.size(); ++i) {
      const Drive drive = FindDrive(connection, drives[i]);
      Require(drive.site == site, ErrorCode::kInvalidInput,
              "drive '" + drives[i] + "' is not one of site '" + site + "'");
      RequireLog(drive);
      Require(std::count(drives.begin(), drives.end(), drives[i]) == 1, ErrorCode::kInvalidInput,
              "drive '" + drives[i] + "' is named twice");
    }
    Job job;
    job.id = NewId();
    job.site = site;
    job.drives = drives;
    job.review = review;
    job.created_at = NowUtc();
    InsertJob(connection, job);
    SetStates(connection, job, DriveState::kQueued);
    RecordAudit(connection, "job.create", job.id, "{\"site\":\"" + site + "\"}");
    return FindJob(connection, job.id);
  });
}

std::optional<Job> ClaimJob(Store& store, bool takes_neighbors) {
  return store.database.Write([&](Connection& connection) -> std::optional<Job> {
    const std::optional<Job> next = NextQueuedJob(connection);
    if (!next) return std::nullopt;
    if (next->new_drive) {
      // After a crash it goes alone: a neighbor may have been the reason.
      std::vector<std::string> neighbors;
      if (takes_neighbors && next->crashes == 0) neighbors = DrivesWaitingBeside(connection, *next);
      SetJobDrives(connection, next->id, DrivesToJoin(connection, *next->new_drive, neighbors));
    } else {
      DropDeletedDrives(connection, next->id);
    }
    StartJob(connection, next->id);
    const Job job = FindJob(connection, next->id);
    SetStates(connection, job, DriveState::kProcessing);
    return job;
  });
}

void FailJob(Store& store, const Job& job, const std::string& code, const std::string& sentence) {
  store.database.Write([&](Connection& connection) {
    if (HasCompanions(connection, job) && GoAlone(connection, job, sentence)) return;
    if (EndJob(connection, job.id, job.attempt, {JobState::kFailed, sentence, code, std::nullopt}))
      FinishJob(connection, job, DriveState::kFailed, sentence);
  });
}

void RecordInspection(Store& store, const std::string& drive, const DriveInspection& inspection) {
  store.database.Write([&](Connection& connection) {
    SetDriveInspection(connection, drive, inspection);
    if (inspection.state != kUnusable) return;
    const Drive found = FindDriveOrTombstone(connection, drive);
    if (!found.job) return;
    const Job job = FindJob(connection, *found.job);
    if (job.drives != std::vector{drive}) return;
    const std::string sentence = inspection.error.value_or("the log cannot be mapped");
    if (FailQueuedJob(connection, job.id, "invalid_input", sentence))
      FinishJob(connection, job, DriveState::kFailed, sentence);
  });
}

void FinishCancelledJob(Store& store, const Job& job) {
  store.database.Write([&](Connection& connection) {
    if (EndJob(connection, job.id, job.attempt,
               {JobState::kCancelled, "cancelled", "cancelled", std::nullopt}))
      FinishJob(connection, job, DriveState::kReceived);
  });
}

void RetryCrashedJob(Store& store, const Job& job, const std::string& code,
                     const std::string& sentence, std::chrono::milliseconds pause) {
  if (job.crashes + 1 >= kMaxCrashes) {
    FailJob(store, job, code, sentence);
  } else {
    Requeue(store, job, Setback::kCrash, sentence, UtcIn(pause));
  }
}

void RecoverJob(Store& store, const Job& job) {
  if (job.is_cancel_asked) return FinishCancelledJob(store, job);
  const int ends = job.service_ends + 1;
  if (ends >= kMaxServiceEnds) {
    FailJob(store, job, "crashed",
            "the service ended " + std::to_string(ends) + " times while the job was running");
  } else {
    Requeue(store, job, Setback::kServiceEnd, "the service ended while the job was running");
  }
}

void ReturnJob(Store& store, const Job& job, const std::string& reason) {
  Requeue(store, job, Setback::kStop, reason);
}

bool CancelWaitingJob(Store& store, const std::string& id) {
  // So that its drive can be deleted.
  return WriteToMakeRoom(store, [&](Connection& connection) {
    const Job job = FindJob(connection, id);
    const bool has_ended = job.state != JobState::kQueued && job.state != JobState::kRunning;
    Require(!has_ended, ErrorCode::kConflict,
            "job '" + id + "' has already ended: it is " + ToText(job.state));
    if (!CancelQueuedJob(connection, id)) return false;
    RecordAudit(connection, "job.cancel", id);
    FinishJob(connection, job, DriveState::kReceived);
    return true;
  });
}

void NoteCancel(Store& store, const std::string& id) {
  WriteToMakeRoom(store, [&](Connection& connection) {
    SetCancelAsked(connection, id);
    RecordAudit(connection, "job.cancel", id);
  });
}

Job RetryJob(Store& store, const std::string& id) {
  return store.database.Write([&](Connection& connection) {
    const Job ended = FindJob(connection, id);
    const bool is_paused = ended.state == JobState::kQueued && ended.not_before;
    const bool can_retry =
        is_paused || ended.state == JobState::kFailed || ended.state == JobState::kCancelled;
    Require(can_retry, ErrorCode::kConflict,
            "only a failed or cancelled job, or one that waits after a crash, can be tried again: "
            "job '" +
                id + "' is " + ToText(ended.state));
    ResetDrives(connection, ended);
    QueueJobAgain(connection, id);
    Job job = FindJob(connection, id);
    Require(!job.drives.empty(), ErrorCode::kConflict,
            "all drives of job '" + id + "' were deleted");
    RequireInputs(connection, job);
    SetStates(connection, job, DriveState::kQueued);
    RecordAudit(connection, "job.retry", id);
    return job;
  });
}

}  // namespace parkade
