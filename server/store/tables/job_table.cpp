#include "server/store/tables/job_table.h"

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "server/store/tables/names.h"
#include "server/store/tables/row.h"

namespace parkade {
namespace {

const std::string kSelect = R"(
  SELECT sequence, id, site, state, attempt, crashes, error, error_code, pid, pid_started, map_version, created_at,
         started_at, finished_at, review, service_ends, new_drive, not_before, engine, engine_id, engine_waits, cancel_asked,
         last_stage
  FROM jobs )";

std::optional<std::string> ReviewToText(const MapReview& review) {
  if (!review.from_version) return std::nullopt;
  nlohmann::json json = {{"from", *review.from_version},
                         {"reject_loops", review.rejected_loops},
                         {"force_loops", review.forced_loops},
                         {"reject_links", review.rejected_links},
                         {"force_links", review.forced_links}};
  if (review.pins) json["pins"] = *review.pins;
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

MapReview ReviewFromText(const std::optional<std::string>& text) {
  if (!text) return {};
  const nlohmann::json json = nlohmann::json::parse(*text);
  const auto words = [&](const char* key) {
    return json.value(key, std::vector<std::string>());  // an older program knew no links
  };
  MapReview review{json.at("from").get<std::int64_t>(),
                   words("reject_loops"),
                   words("force_loops"),
                   words("reject_links"),
                   words("force_links"),
                   std::nullopt};
  if (const auto pins = json.find("pins"); pins != json.end())
    review.pins = pins->get<std::vector<std::string>>();
  return review;
}

Job FromRow(Connection& connection, const Statement& row) {
  Job job;
  job.sequence = row.Integer(0);
  job.id = row.Text(1);
  job.site = row.Text(2);
  job.state = JobStateFromText(row.Text(3));
  job.attempt = static_cast<int>(row.Integer(4));
  job.crashes = static_cast<int>(row.Integer(5));
  job.error = OptionalText(row, 6);
  job.error_code = OptionalText(row, 7);
  if (const auto engine = OptionalText(row, 18))
    job.place = JobPlace{*engine, OptionalText(row, 19), row.Integer(20) != 0,
                         OptionalInteger(row, 8), OptionalInteger(row, 9)};
  job.map_version = OptionalInteger(row, 10);
  job.created_at = row.Text(11);
  job.started_at = OptionalText(row, 12);
  job.finished_at = OptionalText(row, 13);
  job.review = ReviewFromText(OptionalText(row, 14));
  job.service_ends = static_cast<int>(row.Integer(15));
  job.new_drive = OptionalText(row, 16);
  job.not_before = OptionalText(row, 17);
  job.is_cancel_asked = row.Integer(21) != 0;
  job.last_stage = OptionalText(row, 22);
  Statement drives =
      connection.Query("SELECT drive FROM job_drives WHERE job = ? ORDER BY position", job.id);
  while (drives.Step()) job.drives.push_back(drives.Text(0));
  return job;
}

std::string Word(JobState state) { return ToText(state); }

/// SQL for ShownState.
const std::string kShownState =
    "CASE WHEN state = 'running' AND engine_waits THEN 'queued' ELSE state END";

/// Ids of jobs that `job` does the work of.
std::vector<std::string> Companions(Connection& connection, const Job& job) {
  if (!job.new_drive) return {};
  return Texts(connection.Query(R"(
      SELECT other.id FROM jobs other JOIN job_drives ON job_drives.drive = other.new_drive
        WHERE job_drives.job = ?1 AND other.id <> ?1 AND other.state = 'queued' AND other.attempt = 0
        ORDER BY other.sequence)",
                                job.id));
}

}  // namespace

void InsertJob(Connection& connection, const Job& job) {
  connection.Execute(
      "INSERT INTO jobs (id, site, state, created_at, review, new_drive) VALUES (?, ?, ?, ?, ?, ?)",
      job.id, job.site, Word(JobState::kQueued), job.created_at, ReviewToText(job.review),
      job.new_drive);
  SetJobDrives(connection, job.id, job.drives);
}

Job FindJob(Connection& connection, const std::string& id) {
  Statement query = connection.Query(kSelect + "WHERE id = ?", id);
  Require(query.Step(), ErrorCode::kNotFound, "there is no job '" + id + "'");
  return FromRow(connection, query);
}

std::vector<Job> ListJobs(Connection& connection, const Page& page,
                          const std::optional<JobState>& state,
                          const std::optional<std::string>& site, const SiteScope& scope) {
  std::optional<std::string> word;
  if (state) word = Word(*state);
  Statement query = connection.Query(
      kSelect + "WHERE sequence < ? AND (?2 IS NULL OR " + kShownState +
          " = ?2) AND (?3 IS NULL OR site = ?3) AND (?4 IS NULL OR site IN (SELECT value FROM "
          "json_each(?4))) ORDER BY sequence DESC LIMIT ?",
      page.before, word, site, JsonOf(scope), page.limit);
  std::vector<Job> jobs;
  while (query.Step()) jobs.push_back(FromRow(connection, query));
  return jobs;
}

std::vector<Job> RunningJobs(Connection& connection) {
  Statement query =
      connection.Query(kSelect + "WHERE state = ? ORDER BY sequence", Word(JobState::kRunning));
  std::vector<Job> jobs;
  while (query.Step()) jobs.push_back(FromRow(connection, query));
  return jobs;
}

std::optional<Job> NextQueuedJob(Connection& connection) {
  Statement query =
      connection.Query(kSelect + R"(
      WHERE state = ?1 AND (not_before IS NULL OR not_before <= ?3)
        AND (new_drive IS NULL
                           OR NOT EXISTS (SELECT 1 FROM jobs other WHERE other.site = jobs.site AND other.state = ?2))
        AND NOT EXISTS (SELECT 1 FROM job_drives JOIN drives ON drives.id = job_drives.drive
                          WHERE job_drives.job = jobs.id AND drives.inspection_state = ?4
                            AND drives.deleted_at IS NULL)
      ORDER BY sequence LIMIT 1)",
                       Word(JobState::kQueued), Word(JobState::kRunning), NowUtc(), kWaiting);
  if (!query.Step()) return std::nullopt;
  return FromRow(connection, query);
}

std::vector<std::string> DrivesWaitingBeside(Connection& connection, const Job& lead) {
  return Texts(connection.Query(R"(
      SELECT drives.id FROM jobs JOIN drives ON drives.id = jobs.new_drive
        WHERE jobs.site = ?1 AND jobs.state = 'queued' AND jobs.attempt = 0 AND jobs.id <> ?2
          AND drives.deleted_at IS NULL AND drives.log_deleted_at IS NULL
          AND (drives.inspection_state IS NULL OR drives.inspection_state NOT IN (?3, ?4))
          AND drives.sha256 <> (SELECT sha256 FROM drives WHERE id = ?5)
        ORDER BY jobs.sequence LIMIT 16)",
                                lead.site, lead.id, kWaiting, kUnusable, lead.new_drive));
}

bool HasCompanions(Connection& connection, const Job& job) {
  return !Companions(connection, job).empty();
}

std::vector<std::string> EndCompanions(Connection& connection, const Job& job,
                                       std::int64_t version) {
  std::vector<std::string> ids = Companions(connection, job);
  for (const std::string& id : ids)
    connection.Execute(
        "UPDATE jobs SET state = ?, map_version = ?, started_at = ?, finished_at = ? WHERE id = ?",
        Word(JobState::kDone), version, job.started_at, NowUtc(), id);
  return ids;
}

std::vector<std::string> JobsOfVersion(Connection& connection, const std::string& site,
                                       std::int64_t version) {
  return Texts(
      connection.Query("SELECT id FROM jobs WHERE site = ? AND map_version = ?", site, version));
}

std::int64_t CountJobs(Connection& connection, JobState state) {
  Statement query =
      connection.Query("SELECT count(*) FROM jobs WHERE " + kShownState + " = ?", Word(state));
  query.Step();
  return query.Integer(0);
}

std::optional<std::string> RunningJobOf(Connection& connection, const std::string& drive) {
  Statement query = connection.Query(
      "SELECT j.id FROM job_drives jd JOIN jobs j ON j.id = jd.job WHERE jd.drive = ? AND j.state "
      "= ? LIMIT 1",
      drive, Word(JobState::kRunning));
  if (!query.Step()) return std::nullopt;
  return query.Text(0);
}

void SetJobDrives(Connection& connection, const std::string& id,
                  const std::vector<std::string>& drives) {
  connection.Execute("DELETE FROM job_drives WHERE job = ?", id);
  for (size_t i = 0; i < drives.size(); ++i)
    connection.Execute("INSERT INTO job_drives (job, drive, position) VALUES (?, ?, ?)", id,
                       drives[i], i);
}

void DropDeletedDrives(Connection& connection, const std::string& id) {
  connection.Execute(
      "DELETE FROM job_drives WHERE job = ? AND drive IN (SELECT id FROM drives WHERE deleted_at "
      "IS NOT NULL)",
      id);
}

void StartJob(Connection& connection, const std::string& id) {
  connection.Execute(
      "UPDATE jobs SET state = ?, attempt = attempt + 1, started_at = ?, error = NULL, error_code "
      "= NULL, not_before = NULL, engine = NULL, engine_id = NULL, engine_waits = 0, last_stage = "
      "NULL WHERE "
      "id = ?",
      Word(JobState::kRunning), NowUtc(), id);
}

void SetLastStage(Connection& connection, const std::string& id, int attempt,
                  const std::string& stage) {
  connection.Execute("UPDATE jobs SET last_stage = ? WHERE id = ? AND attempt = ? AND state = ?",
                     stage, id, attempt, Word(JobState::kRunning));
}

void SetJobPlace(Connection& connection, const std::string& id, int attempt,
                 const JobPlace& place) {
  connection.Execute(
      R"(UPDATE jobs SET started_at = CASE WHEN engine_waits AND NOT ?1 THEN ?2 ELSE started_at END,
                         engine_waits = ?1, engine = ?3, engine_id = ?4, pid = ?5, pid_started = ?6
         WHERE id = ?7 AND attempt = ?8 AND state = ?9)",
      place.waits ? 1 : 0, NowUtc(), place.engine, place.id, place.pid, place.pid_started, id,
      attempt, Word(JobState::kRunning));
}

bool EndJob(Connection& connection, const std::string& id, int attempt, const JobEnd& end) {
  return connection.Execute(
             R"(UPDATE jobs SET state = ?, error = ?, error_code = ?, map_version = ?, finished_at = ?,
                                pid = NULL, pid_started = NULL, engine_waits = 0
                WHERE id = ? AND attempt = ? AND state = ?)",
             Word(end.state), end.error, end.error_code, end.map_version, NowUtc(), id, attempt,
             Word(JobState::kRunning)) == 1;
}

bool RequeueJob(Connection& connection, const std::string& id, int attempt, Setback setback,
                const std::string& reason, const std::optional<std::string>& not_before) {
  return connection.Execute(
             R"(UPDATE jobs SET state = ?, crashes = crashes + ?, service_ends = service_ends + ?, error = ?,
                                not_before = ?, pid = NULL, pid_started = NULL, engine_waits = 0
                WHERE id = ? AND attempt = ? AND state = ?)",
             Word(JobState::kQueued), setback == Setback::kCrash ? 1 : 0,
             setback == Setback::kServiceEnd ? 1 : 0, reason, not_before, id, attempt,
             Word(JobState::kRunning)) == 1;
}

void QueueJobAgain(Connection& connection, const std::string& id) {
  connection.Execute(
      R"(UPDATE jobs SET state = ?, crashes = 0, service_ends = 0, error = NULL, error_code = NULL,
                         started_at = NULL, finished_at = NULL, not_before = NULL,
                         cancel_asked = 0 WHERE id = ?)",
      Word(JobState::kQueued), id);
}

bool FailQueuedJob(Connection& connection, const std::string& id, const std::string& code,
                   const std::string& sentence) {
  return connection.Execute(
             R"(UPDATE jobs SET state = ?, error = ?, error_code = ?, finished_at = ?
                WHERE id = ? AND state = ?)",
             Word(JobState::kFailed), sentence, code, NowUtc(), id, Word(JobState::kQueued)) == 1;
}

void SetCancelAsked(Connection& connection, const std::string& id) {
  connection.Execute("UPDATE jobs SET cancel_asked = 1 WHERE id = ?", id);
}

bool CancelQueuedJob(Connection& connection, const std::string& id) {
  return connection.Execute(
             R"(UPDATE jobs SET state = ?, error = 'cancelled', error_code = 'cancelled', finished_at = ?,
                                not_before = NULL
                WHERE id = ? AND state = ?)",
             Word(JobState::kCancelled), NowUtc(), id, Word(JobState::kQueued)) == 1;
}

}  // namespace parkade
