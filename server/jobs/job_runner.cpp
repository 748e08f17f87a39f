#include "server/jobs/job_runner.h"

#include <algorithm>
#include <csignal>

#include "core/error.h"
#include "core/log_fields.h"
#include "server/jobs/attempt_folder.h"
#include "server/jobs/worker_exit.h"
#include "server/store/care/stored_files.h"
#include "server/store/job_queue.h"
#include "server/store/publish_map.h"
#include "server/store/tables/drive_table.h"
#include "server/store/tables/job_table.h"

namespace parkade {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kPollInterval{200};
constexpr milliseconds kQueueInterval{2000};
constexpr milliseconds kRetryInterval{1000};
constexpr double kMinProgressForEta = 0.02;

/// Kills the worker of a job that an earlier service left behind, if it lives.
void KillLeftOver(const Job& job) {
  if (!job.pid || !job.pid_started) return;
  const auto pid = static_cast<pid_t>(*job.pid);
  if (ProcessStartTime(pid) == job.pid_started) ::kill(-pid, SIGKILL);
}

}  // namespace

JobRunner::JobRunner(Store& store, EventHub& events, JobRunnerOptions options)
    : store_(store), events_(events), options_(std::move(options)) {
  left_over_ = store_.database.Read([](Connection& connection) {
    return ListJobs(connection, {.limit = 1000}, JobState::kRunning, std::nullopt);
  });
  RecoverJobs();
  for (int i = 0; i < options_.num_workers; ++i) threads_.emplace_back([this] { Work(); });
}

JobRunner::~JobRunner() { Stop(); }

/// False while a full disk does not take it: nothing may start before.
bool JobRunner::RecoverJobs() {
  const std::lock_guard lock(recovery_mutex_);
  try {
    for (; !left_over_.empty(); left_over_.pop_back()) {
      const Job& job = left_over_.back();
      KillLeftOver(job);
      RecoverJob(store_, job);
      Log(LogLevel::kWarning, "job recovered", {{"job", job.id}, {"attempt", job.attempt}});
    }
  } catch (const Error& error) {
    LogError(std::string("jobs not recovered error=") + error.what());
  }
  return left_over_.empty();
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
    // The job runs by the store, but not here: it is about to end.
    const bool is_in_time = found != running_.end() && !found->second.is_ending;
    Require(is_in_time, ErrorCode::kConflict, "job '" + job_id + "' is just ending");
    found->second.is_cancelled = true;
    return;
  }
  const Job job =
      store_.database.Read([&](Connection& connection) { return FindJob(connection, job_id); });
  PublishStates(job);
}

std::optional<JobProgress> JobRunner::ProgressOf(const std::string& job_id) const {
  const std::lock_guard lock(mutex_);
  const auto found = running_.find(job_id);
  if (found == running_.end()) return std::nullopt;
  const WorkerProgress& latest = found->second.latest;
  JobProgress progress{latest.stage, latest.progress, latest.eta};
  const double elapsed =
      std::chrono::duration<double>(steady_clock::now() - found->second.started).count();
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
      if (RecoverJobs()) job = ClaimJob(store_);
    } catch (const Error& error) {
      LogError(std::string("queue error=") +
               error.what());  // most likely the disk is full: try again later
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
  const LogContext context(LogFields{{"job", job.id}, {"attempt", job.attempt}});
  LogInfo("job started");
  {
    const std::lock_guard lock(mutex_);
    running_[job.id] = {.attempt = job.attempt, .latest = {}, .started = steady_clock::now()};
  }
  PublishStates(job);
  try {
    RunWorker(job);
  } catch (const DiskFailure& failure) {
    store_.database.Freeze(failure.what());  // the next start does the job again
  } catch (const Error& error) {
    End(job, [&] { FailJob(store_, job, JobErrorCode(error.code()), error.what()); });
  } catch (const std::exception& error) {
    LogError(std::string("job exception=") + error.what());
    End(job, [&] {
      FailJob(store_, job, "internal", "the service could not run the job; its log has the reason");
    });
  }
  {
    const std::lock_guard lock(mutex_);
    const auto found = running_.find(job.id);
    // Put back into the queue, it may already be at its next attempt, in another thread.
    if (found != running_.end() && found->second.attempt == job.attempt) running_.erase(found);
  }
  PublishStates(job);
  LogInfo("job ended");
}

void JobRunner::RunWorker(const Job& job) {
  const AttemptFolder folder(store_, job);
  CheckLogs(job);
  ProgressReader progress(folder.spec().progress);
  WatchedWorker worker(options_.command(folder.spec()), folder, options_.limits);
  store_.database.Write([&](Connection& connection) {
    SetJobProcess(connection, job.id, job.attempt, worker.process().pid(),
                  ProcessStartTime(worker.process().pid()).value_or(0));
  });

  switch (Supervise(job, worker, progress)) {
    case Interruption::kCancelled: End(job, [&] { FinishCancelledJob(store_, job); }); return;
    case Interruption::kStopped: End(job, [&] { ReturnJob(store_, job); }); return;
    case Interruption::kTrouble: {
      const WorkerExit end =
          ExplainTrouble(worker.trouble(), worker.limits(), progress.latest().stage);
      End(job, [&] { FailJob(store_, job, end.code, end.sentence); });
      return;
    }
    case Interruption::kNone: break;
  }
  const WorkerExit end = UnderstandEnd(worker.process().Wait(milliseconds{0}).value(),
                                       progress.latest(), worker.WasKilledForMemory());
  if (end.kind == WorkerExit::Kind::kFailed)
    End(job, [&] { FailJob(store_, job, end.code, end.sentence); });
  if (end.kind == WorkerExit::Kind::kCrashed)
    End(job, [&] { RetryCrashedJob(store_, job, end.code, end.sentence, PauseAfter(job)); });
  if (end.kind == WorkerExit::Kind::kDone) Publish(job, folder.spec().out);
}

/// A log that rotted would give a map that is wrong without a word.
void JobRunner::CheckLogs(const Job& job) {
  for (const std::string& id : job.drives) {
    const Drive drive =
        store_.database.Read([&](Connection& connection) { return FindDrive(connection, id); });
    const StoredFile log{DataDirectory::LogPath(drive.sha256), drive.bytes, drive.sha256};
    const auto damage = CheckStoredFile(store_.directory.root(), log, [&] {
      return Interrupted(job, WorkerTrouble::kNone) == Interruption::kNone;
    });
    if (!damage) continue;
    RecordFileCheck(store_, log.path, damage);
    throw Error(ErrorCode::kInternal,
                "the stored log of drive '" + drive.name + "' " + *damage + ": upload it again");
  }
}

std::chrono::milliseconds JobRunner::PauseAfter(const Job& crashed) const {
  if (options_.limits.crash_pauses.empty()) return milliseconds{0};
  const auto last = options_.limits.crash_pauses.size() - 1;
  return options_.limits.crash_pauses[std::min(static_cast<std::size_t>(crashed.crashes), last)];
}

void JobRunner::Publish(const Job& job, const std::filesystem::path& products) {
  const SealedMap sealed = SealMap(products);
  if (BeginEnd(job)) {
    Persist([&] { FinishCancelledJob(store_, job); });
    return;
  }
  const MapVersion map = PublishMap(store_, job, sealed);
  events_.Publish("map", map.site + "/" + std::to_string(map.version));
}

JobRunner::Interruption JobRunner::Supervise(const Job& job, WatchedWorker& worker,
                                             ProgressReader& progress) {
  Interruption interruption = Interruption::kNone;
  steady_clock::time_point kill_time;
  while (!worker.process().Wait(kPollInterval)) {
    const bool has_spoken = progress.Poll();
    if (has_spoken) Announce(job, progress.latest());
    worker.Look(has_spoken);
    const steady_clock::time_point now = steady_clock::now();
    if (interruption == Interruption::kNone) {
      interruption = Interrupted(job, worker.trouble());
      if (interruption == Interruption::kNone) continue;
      worker.process().Signal(SIGTERM);
      // Memory is not to grow on meanwhile.
      kill_time = now;
      if (worker.trouble() != WorkerTrouble::kOverMemory) kill_time += options_.stop_patience;
    }
    if (now >= kill_time) worker.process().Signal(SIGKILL);
  }
  progress.Poll();
  worker.LookAtEnd(worker.process().Wait(milliseconds{0}).value());
  const bool is_trouble =
      interruption == Interruption::kNone && worker.trouble() == WorkerTrouble::kOverMemory;
  return is_trouble ? Interruption::kTrouble : interruption;
}

JobRunner::Interruption JobRunner::Interrupted(const Job& job, WorkerTrouble trouble) const {
  const std::lock_guard lock(mutex_);
  if (running_.at(job.id).is_cancelled) return Interruption::kCancelled;
  if (is_stopping_) return Interruption::kStopped;
  return trouble == WorkerTrouble::kNone ? Interruption::kNone : Interruption::kTrouble;
}

/// From here on the job cannot be cancelled any more. True when it was before.
bool JobRunner::BeginEnd(const Job& job) {
  const std::lock_guard lock(mutex_);
  Running& running = running_.at(job.id);
  running.is_ending = true;
  return running.is_cancelled;
}

/// Ends an attempt by `change`, or as cancelled when it was cancelled in its very last moment.
template <typename Change>
void JobRunner::End(const Job& job, const Change& change) {
  if (BeginEnd(job)) {
    Persist([&] { FinishCancelledJob(store_, job); });
  } else {
    Persist(change);
  }
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

/// A job's end must not get lost on a full disk: at some time there is room again.
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
