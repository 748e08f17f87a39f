#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "server/store/store.h"
#include "server/store/tables/records.h"

namespace parkade {

// The changes of state a job goes through, each one transaction that moves the
// job's drives along:
//
//   queued -> running -> done | failed | cancelled | queued (once more)
//
// A job with a new drive moves that one only: those it is joined with are in a map. A drive in a
// map is ready and stays so.

/// Queues a job that maps `drives` of a site; all of the site's where empty.
/// Throws Error{kNotFound} for an unknown site or drive, Error{kInvalidInput}
/// when there is nothing to map, or several drives without `merge_drives`. With a review that
/// starts from a version, the drives are that version's where none are named, without those deleted
/// since (Error{kConflict} when none is left), and must be among them otherwise.
Job QueueMap(Store& store, const std::string& site, std::vector<std::string> drives,
             bool merge_drives, const MapReview& review = {});

/// Takes the oldest queued job, if any, and starts an attempt of it, without the drives that were
/// deleted since it was queued. None may be left. A job with a new drive is joined with what its
/// site has now, and waits while another job of its site runs. With `takes_neighbors`, new drives
/// that wait beside it come into the same map: their jobs are done with its (PublishMap).
std::optional<Job> ClaimJob(Store& store, bool takes_neighbors = false);

/// How many attempts at a job may end by a crash of its worker.
constexpr int kMaxCrashes = 3;
/// How many attempts may end with the service. Mostly these have nothing to do with the job, but a
/// job that takes the whole machine down must not do so for ever.
constexpr int kMaxServiceEnds = 20;

/// Ends an attempt that will not be tried again, but for one that took in drives of other jobs,
/// which is tried once more without them. Nothing happens when it is no longer the running one.
void FailJob(Store& store, const Job& job, const std::string& code, const std::string& sentence);
void FinishCancelledJob(Store& store, const Job& job);

/// Notes what a first look at a drive's log found. Where no map can be made of it, the job that
/// waits with this drive as its only or new one fails at once.
void RecordInspection(Store& store, const std::string& drive, const DriveInspection& inspection);

/// Puts an attempt whose worker crashed back into the queue, where it waits for `pause`, or fails
/// it with `code` after kMaxCrashes crashes.
void RetryCrashedJob(Store& store, const Job& job, const std::string& code,
                     const std::string& sentence, std::chrono::milliseconds pause);

/// Puts an attempt back into the queue that an earlier service was at when it died, or fails it
/// after kMaxServiceEnds of them; ends it where it is to be cancelled.
void RecoverJob(Store& store, const Job& job);

/// Puts an attempt back into the queue that was stopped through no fault of its own, as when the
/// service itself stops. `reason` is a sentence.
void ReturnJob(Store& store, const Job& job, const std::string& reason = "the service was stopped");

/// Takes a queued job out of the queue; false when it is running. Throws
/// Error{kNotFound}, Error{kConflict} when it has ended.
bool CancelWaitingJob(Store& store, const std::string& id);

/// Notes that a running job is to end as cancelled: RecoverJob does so after a service's end.
void NoteCancel(Store& store, const std::string& id);

/// Queues a failed or cancelled job again, or ends the pause of one that crashed. Throws
/// Error{kNotFound}, Error{kConflict} in another state or when all drives of it were deleted.
Job RetryJob(Store& store, const std::string& id);

}  // namespace parkade
