#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/store/tables/database.h"
#include "server/store/tables/records.h"
#include "server/store/tables/site_scope.h"

namespace parkade {

// Rows of `jobs`. Every change of a running job names the attempt it belongs to:
// a worker that was given up cannot change what came after it.

/// Inserts a queued job over `job.drives`.
void InsertJob(Connection& connection, const Job& job);

/// Throws Error{kNotFound}.
Job FindJob(Connection& connection, const std::string& id);

/// Newest first; only those of sites in `scope`, and shown as in `state` or of `site` where given.
std::vector<Job> ListJobs(Connection& connection, const Page& page,
                          const std::optional<JobState>& state,
                          const std::optional<std::string>& site, const SiteScope& scope = {});

/// All jobs with a running attempt, also of those that wait with an engine; oldest first.
std::vector<Job> RunningJobs(Connection& connection);

/// The oldest queued job that may start now: none whose drives still wait for a first look. One
/// with a new drive waits for jobs of its site that run: their map is not there to be joined with
/// yet, and would come after one that knows nothing of it.
std::optional<Job> NextQueuedJob(Connection& connection);
/// New drives of jobs at the site of `lead` that wait as it did and were never tried, oldest first,
/// some dozen at most: one map can take them all in.
std::vector<std::string> DrivesWaitingBeside(Connection& connection, const Job& lead);
/// Whether a running job maps new drives of jobs that wait.
bool HasCompanions(Connection& connection, const Job& job);
/// Queued, never tried -> done, for jobs whose new drives are among `drives`, since `job` has made
/// a version with them. Returns their ids.
std::vector<std::string> EndCompanions(Connection& connection, const Job& job,
                                       std::int64_t version);
/// Ids of the jobs that are done with a version.
std::vector<std::string> JobsOfVersion(Connection& connection, const std::string& site,
                                       std::int64_t version);
/// How many are shown as in `state`.
std::int64_t CountJobs(Connection& connection, JobState state);

/// The running job that maps a drive, if any.
std::optional<std::string> RunningJobOf(Connection& connection, const std::string& drive);

void SetJobDrives(Connection& connection, const std::string& id,
                  const std::vector<std::string>& drives);
/// Takes drives off the job's list that were deleted.
void DropDeletedDrives(Connection& connection, const std::string& id);

/// Queued -> running with attempt + 1.
void StartJob(Connection& connection, const std::string& id);

/// Notes where a running attempt is. One that waited until now starts now.
void SetJobPlace(Connection& connection, const std::string& id, int attempt, const JobPlace& place);

/// Notes the stage of a running attempt that is about to end without a map.
void SetLastStage(Connection& connection, const std::string& id, int attempt,
                  const std::string& stage);

struct JobEnd {
  JobState state = JobState::kDone;
  std::optional<std::string> error, error_code;
  std::optional<std::int64_t> map_version;
};

/// Running -> an end. False when the attempt is not the running one.
bool EndJob(Connection& connection, const std::string& id, int attempt, const JobEnd& end);

/// Why an attempt ended without a result. Crashes and ends of the service are counted.
enum class Setback { kCrash, kServiceEnd, kStop };

/// Running -> queued, until `not_before` where given. False when the attempt is not the running
/// one.
bool RequeueJob(Connection& connection, const std::string& id, int attempt, Setback setback,
                const std::string& reason, const std::optional<std::string>& not_before);

/// Failed, cancelled or waiting after a crash -> queued, with the counts of interruptions
/// forgotten.
void QueueJobAgain(Connection& connection, const std::string& id);

/// Queued -> failed. False when it is not queued.
bool FailQueuedJob(Connection& connection, const std::string& id, const std::string& code,
                   const std::string& sentence);

/// Notes that a running job is to end as cancelled.
void SetCancelAsked(Connection& connection, const std::string& id);

/// Queued -> cancelled. False when it is not queued.
bool CancelQueuedJob(Connection& connection, const std::string& id);

}  // namespace parkade
