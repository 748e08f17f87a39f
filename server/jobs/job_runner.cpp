#include "server/jobs/job_runner.h"

#include <csignal>

#include "core/error.h"
#include "core/log.h"
#include "server/jobs/attempt_folder.h"
#include "server/jobs/worker_end.h"
#include "server/jobs/worker_process.h"
#include "server/store/job_queue.h"
#include "server/store/job_table.h"
#include "server/store/publish_map.h"

namespace parkade {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kPollInterval{200};
constexpr milliseconds kQueueInterval{2000};
constexpr milliseconds kRetryInterval{1000};
constexpr double kMinProgressForEta = 0.02;

const char* CodeOf(const Error& error) {
  switch (error.code()) {
    case ErrorCode::kInvalidInput: return "invalid_input";
    case ErrorCode::kNotFound: return "not_found";
    case ErrorCode::kConflict: return "conflict";
    case ErrorCode::kDiskFull: return "disk_full";
    case ErrorCode::kUsage:
    case ErrorCode::kInternal: break;
  }
  return "internal";
}

/// Kills the worker of a job that an earlier service left behind, if it lives.
void KillLeftOver(const Job& job) {
  if (!job.pid || !job.pid_started) return;
  const auto pid = static_cast<pid_t>(*job.pid);
  if (ProcessStartTime(pid) == job.pid_started) ::kill(-pid, SIGKILL);
}

}  // namespace

JobRunner::JobRunner(Store& store, EventHub& events, JobRunnerOptions options)
    : store_(store), events_(events), options_(std::move(options)) {
  RecoverJobs();
  for (int i = 0; i < options_.num_workers; ++i) threads_.emplace_back([this] { Work(); });
}

JobRunner::~JobRunner() { Stop(); }

void JobRunner::RecoverJobs() {
  const std::vector<Job> left_over = store_.database.Read(
      [](Connection& connection) { return ListJobs(connection, {.limit = 1000}, JobState::kRunning, std::nullopt); });
  for (const Job& job : left_over) {
    KillLeftOver(job);
    RecoverJob(store_, job);
    LogWarning("job recovered id=" + job.id + " attempt=" + std::to_string(job.attempt));
  }
}

void JobRunner::Wake() { changed_.notify_all(); }

void JobRunner::Stop() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
}

void JobRunner::Cancel(const std::string& job_id) {
  if (!CancelWaitingJob(store_, job_id)) {
    const std::lock_guard lock(mutex_);
    const auto found = running_.find(job_id);
    // It is running in the store, but here it is not: it is about to end.
    Require(found != running_.end(), ErrorCode::kConflict, "job '" + job_id + "' is just ending");
    found->second.is_cancelled = true;
    return;
  }
  const Job job = store_.database.Read([&](Connection& connection) { return FindJob(connection, job_id); });
  PublishStates(job);
}

std::optional<JobProgress> JobRunner::ProgressOf(const std::string& job_id) const {
  const std::lock_guard lock(mutex_);
  const auto found = running_.find(job_id);
  if (found == running_.end()) return std::nullopt;
  const WorkerProgress& latest = found->second.latest;
  JobProgress progress{latest.stage, latest.progress, latest.eta};
  const double elapsed = std::chrono::duration<double>(steady_clock::now() - found->second.started).count();
  if (!latest.eta && latest.progress >= kMinProgressForEta)
    progress.eta_seconds = elapsed * (1 - latest.progress) / latest.progress;
  return progress;
}

void JobRunner::Work() {
  for (;;) {
    {
      const std::lock_guard lock(mutex_);
      if (is_stopping_) return;
    }
    std::optional<Job> job;
    try {
      job = ClaimJob(store_);
    } catch (const Error& error) {
      LogError(std::string("queue error=") + error.what());  // a full disk, most likely: try again later
    }
    if (job) {
      RunAttempt(*job);
      continue;
    }
    std::unique_lock lock(mutex_);
    if (!is_stopping_) changed_.wait_for(lock, kQueueInterval);
  }
}

void JobRunner::RunAttempt(const Job& job) {
  LogInfo("job started id=" + job.id + " attempt=" + std::to_string(job.attempt));
  {
    const std::lock_guard lock(mutex_);
    running_[job.id] = {{}, steady_clock::now(), false};
  }
  PublishStates(job);
  try {
    RunWorker(job);
  } catch (const Error& error) {
    Persist([&] { FailJob(store_, job, CodeOf(error), error.what()); });
  } catch (const std::exception& error) {
    LogError("job id=" + job.id + " exception=" + error.what());
    Persist([&] { FailJob(store_, job, "internal", "the service could not run the job; its log has the reason"); });
  }
  {
    const std::lock_guard lock(mutex_);
    running_.erase(job.id);
  }
  PublishStates(job);
  LogInfo("job ended id=" + job.id + " attempt=" + std::to_string(job.attempt));
}

void JobRunner::RunWorker(const Job& job) {
  const AttemptFolder folder(store_, job);
  ProgressReader progress(folder.spec().progress);
  WorkerProcess worker(options_.command(folder.spec()), folder.path(), folder.LogFile());
  store_.database.Write([&](Connection& connection) {
    SetJobProcess(connection, job.id, job.attempt, worker.pid(), ProcessStartTime(worker.pid()).value_or(0));
  });

  switch (Supervise(job, worker, progress)) {
    case Interruption::kCancelled: Persist([&] { FinishCancelledJob(store_, job); }); return;
    case Interruption::kStopped: Persist([&] { ReturnJob(store_, job); }); return;
    case Interruption::kTimedOut:
      throw Error(ErrorCode::kInternal, "the job took longer than " + std::to_string(options_.time_limit.count()) +
                                            " seconds and was stopped");
    case Interruption::kNone: break;
  }
  const WorkerEnd end = UnderstandEnd(worker.Wait(milliseconds{0}).value(), progress.latest());
  if (end.kind == WorkerEnd::Kind::kFailed) Persist([&] { FailJob(store_, job, end.code, end.sentence); });
  if (end.kind == WorkerEnd::Kind::kCrashed) Persist([&] { RetryCrashedJob(store_, job, end.sentence); });
  if (end.kind == WorkerEnd::Kind::kDone) {
    const MapVersion map = PublishMap(store_, job, folder.spec().out);
    events_.Publish("map", map.site + "/" + std::to_string(map.version));
  }
}

JobRunner::Interruption JobRunner::Supervise(const Job& job, WorkerProcess& worker, ProgressReader& progress) {
  Interruption interruption = Interruption::kNone;
  steady_clock::time_point kill_time;
  while (!worker.Wait(kPollInterval)) {
    if (progress.Poll()) Announce(job, progress.latest());
    const steady_clock::time_point now = steady_clock::now();
    if (interruption != Interruption::kNone) {
      if (now >= kill_time) worker.Signal(SIGKILL);
      continue;
    }
    interruption = Interrupted(job);
    if (interruption == Interruption::kNone) continue;
    worker.Signal(SIGTERM);
    kill_time = now + options_.stop_patience;
  }
  progress.Poll();
  // Cancelled in its very last moment is cancelled all the same.
  const bool is_cancelled = interruption == Interruption::kNone && Interrupted(job) == Interruption::kCancelled;
  return is_cancelled ? Interruption::kCancelled : interruption;
}

JobRunner::Interruption JobRunner::Interrupted(const Job& job) const {
  const std::lock_guard lock(mutex_);
  const Running& running = running_.at(job.id);
  if (running.is_cancelled) return Interruption::kCancelled;
  if (is_stopping_) return Interruption::kStopped;
  if (steady_clock::now() - running.started > options_.time_limit) return Interruption::kTimedOut;
  return Interruption::kNone;
}

void JobRunner::Announce(const Job& job, const WorkerProgress& latest) {
  {
    const std::lock_guard lock(mutex_);
    running_.at(job.id).latest = latest;
  }
  events_.Publish("job", job.id);
}

void JobRunner::PublishStates(const Job& job) {
  events_.Publish("job", job.id);
  for (const std::string& drive : job.drives) events_.Publish("drive", drive);
}

/// A job's end must not get lost on a full disk: there is room again at some time.
template <typename Change>
void JobRunner::Persist(const Change& change) {
  for (;;) {
    try {
      change();
      return;
    } catch (const Error& error) {
      LogError(std::string("job state not stored error=") + error.what());
      // The next service finds the job running without a process and goes on.
      if (error.code() != ErrorCode::kDiskFull) return;
    }
    std::unique_lock lock(mutex_);
    if (is_stopping_) return;
    changed_.wait_for(lock, kRetryInterval);
  }
}

}  // namespace parkade
