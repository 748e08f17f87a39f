#include "server/jobs/job_runner.h"

#include <algorithm>

#include "core/error.h"
#include "core/log.h"
#include "server/jobs/check_logs.h"
#include "server/jobs/local_engine.h"
#include "server/store/disk/share_files.h"
#include "server/store/job_queue.h"
#include "server/store/job_work.h"
#include "server/store/publish_map.h"
#include "server/store/tables/job_table.h"

namespace parkade {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kQueueInterval{2000};
constexpr milliseconds kRetryInterval{1000};
constexpr double kMinProgressForEta = 0.02;

std::shared_ptr<JobEngine> EngineOf(const JobRunnerOptions& options) {
  if (options.engine) return options.engine;
  return std::make_shared<LocalEngine>(options.command, options.limits, options.stop_patience);
}

}  // namespace

JobRunner::JobRunner(Store& store, EventHub& events, JobRunnerOptions options)
    : store_(store),
      events_(events),
      options_(std::move(options)),
      engine_(EngineOf(options_)),
      left_over_(store, *engine_) {
  left_over_.Recover();
  // Jobs that go on need someone to look after them, also where there were more workers before.
  for (int i = 0; i < std::max(options_.num_workers, left_over_.size()); ++i)
    threads_.emplace_back([this, i] { Work(/*claims=*/i < options_.num_workers); });
}

JobRunner::~JobRunner() { Stop(); }

/// A job to be at next: one to take up, else one from the queue where `claims`. Nothing while the
/// jobs of an earlier service are not recovered.
std::optional<Job> JobRunner::NextJob(bool claims) {
  if (!left_over_.Recover()) return std::nullopt;
  if (auto job = left_over_.TakeUp()) return job;
  return claims ? ClaimJob(store_, engine_->capabilities().prepares_drives) : std::nullopt;
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
    {
      const std::lock_guard lock(mutex_);
      const auto found = running_.find(job_id);
      // The job runs by the store, but not here: it is about to end.
      const bool is_in_time = found != running_.end() && !found->second.is_ending;
      Require(is_in_time, ErrorCode::kConflict, "job '" + job_id + "' is just ending");
      found->second.is_cancelled = true;
    }
    NoteCancel(store_, job_id);  // for the next service, should this one end before the job
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
  JobProgress progress{latest.stage, latest.progress, latest.eta, found->second.reason};
  const double elapsed =
      std::chrono::duration<double>(steady_clock::now() - found->second.started).count();
  if (!latest.eta && latest.progress >= kMinProgressForEta)
    progress.eta_seconds = elapsed * (1 - latest.progress) / latest.progress;
  return progress;
}

void JobRunner::Work(bool claims) {
  for (;;) {
    {
      const std::lock_guard lock(mutex_);
      if (is_stopping_) return;
    }
    std::optional<Job> job;
    try {
      job = NextJob(claims);
    } catch (const Error& error) {
      LogError(std::string("queue error=") +
               error.what());  // most likely the disk is full: try again later
    }
    if (job) {
      RunAttempt(*job);
      continue;
    }
    if (!claims) return;
    std::unique_lock lock(mutex_);
    if (!is_stopping_) changed_.wait_for(lock, kQueueInterval);
  }
}

void JobRunner::RunAttempt(const Job& job) {
  const LogContext context(LogFields{{"job", job.id}, {"attempt", job.attempt}});
  LogInfo("job started");
  {
    const std::lock_guard lock(mutex_);
    Running& running = running_[job.id] = {};
    running.attempt = job.attempt;
    running.is_cancelled = job.is_cancel_asked;
    running.started = steady_clock::now();
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
  AttemptFolder folder(store_, job);
  if (!job.place) CheckLogs(store_, job, [&] { return Interrupted(job) == Interruption::kNone; });
  const std::unique_ptr<EngineAttempt> attempt = engine_->Run(job, folder);
  store_.database.Write([&](Connection& connection) {
    SetJobPlace(connection, job.id, job.attempt, attempt->place());
  });
  switch (Supervise(job, *attempt)) {
    case Interruption::kCancelled: End(job, [&] { FinishCancelledJob(store_, job); }); return;
    case Interruption::kNone: EndBy(job, folder, *attempt); return;
    case Interruption::kStopped: break;
  }
  if (engine_->capabilities().outlives_service) {
    folder.Keep();
  } else {
    End(job, [&] { ReturnJob(store_, job); });
  }
}

/// Does what the end of an attempt asks for that was not interrupted.
void JobRunner::EndBy(const Job& job, const AttemptFolder& folder, const EngineAttempt& attempt) {
  const WorkerExit end = attempt.Exit();
  switch (end.kind) {
    case WorkerExit::Kind::kDone: {
      if (job.place && !folder.HasProducts(attempt.products())) {
        End(job, [&] { ReturnJob(store_, job, "the service ended while it published the map"); });
        return;
      }
      const std::filesystem::path products = folder.TakeProducts(attempt.products());
      if (folder.spec().from) ShareFilesWith(*folder.spec().from, products);
      Publish(job, products);
      return;
    }
    case WorkerExit::Kind::kFailed:
      if (end.code == "disk_full") DropWork(store_, job.id);
      End(job, [&] { FailJob(store_, job, end.code, end.sentence); });
      return;
    case WorkerExit::Kind::kCrashed:
      End(job, [&] { RetryCrashedJob(store_, job, end.code, end.sentence, PauseAfter(job)); });
      return;
    case WorkerExit::Kind::kCancelled: End(job, [&] { FinishCancelledJob(store_, job); }); return;
    case WorkerExit::Kind::kReturned: End(job, [&] { ReturnJob(store_, job, end.sentence); });
  }
}

std::chrono::milliseconds JobRunner::PauseAfter(const Job& crashed) const {
  if (options_.limits.crash_pauses.empty()) return milliseconds{0};
  const auto last = options_.limits.crash_pauses.size() - 1;
  return options_.limits.crash_pauses[std::min(static_cast<std::size_t>(crashed.crashes), last)];
}

void JobRunner::Publish(const Job& job, const std::filesystem::path& products) {
  const std::optional<SealedMap> sealed =
      SealMap(products, [&] { return Interrupted(job) != Interruption::kCancelled; });
  if (BeginEnd(job) || !sealed) {
    KeepStage(job);
    Persist([&] { FinishCancelledJob(store_, job); });
    return;
  }
  const MapVersion map = PublishMap(store_, job, *sealed);
  DropWork(store_, job.id);
  events_.Publish("map", map.site + "/" + std::to_string(map.version));
  for (const std::string& id : store_.database.Read([&](Connection& connection) {
         return JobsOfVersion(connection, map.site, map.version);
       }))
    events_.Publish("job", id);
}

/// Follows an attempt to its end, or to the stop of a service that it outlives.
JobRunner::Interruption JobRunner::Supervise(const Job& job, EngineAttempt& attempt) {
  Interruption interruption = Interruption::kNone;
  JobPlace stored = attempt.place();
  for (;;) {
    if (interruption == Interruption::kNone) {
      interruption = Interrupted(job);
      if (interruption == Interruption::kStopped && engine_->capabilities().outlives_service)
        return interruption;
      if (interruption != Interruption::kNone) attempt.Cancel();
    }
    const std::string reason = attempt.reason();
    const AttemptNews news = attempt.Look();
    const JobPlace place = attempt.place();
    const bool has_moved = place != stored;
    if (has_moved && StorePlace(job, place)) stored = place;
    if (has_moved || news.has_spoken || attempt.reason() != reason) Announce(job, attempt);
    if (news.has_ended) return interruption;
  }
}

JobRunner::Interruption JobRunner::Interrupted(const Job& job) const {
  const std::lock_guard lock(mutex_);
  if (running_.at(job.id).is_cancelled) return Interruption::kCancelled;
  return is_stopping_ ? Interruption::kStopped : Interruption::kNone;
}

/// False where the disk did not take it: to be tried again.
bool JobRunner::StorePlace(const Job& job, const JobPlace& place) {
  try {
    store_.database.Write(
        [&](Connection& connection) { SetJobPlace(connection, job.id, job.attempt, place); });
    return true;
  } catch (const Error& error) {
    LogError("place of job id=" + job.id + " not stored error=" + error.what());
    return false;
  }
}

/// From here on the job cannot be cancelled any more. True when it was before.
bool JobRunner::BeginEnd(const Job& job) {
  const std::lock_guard lock(mutex_);
  Running& running = running_.at(job.id);
  running.is_ending = true;
  return running.is_cancelled;
}

/// So that people see how far a job came that made no map.
void JobRunner::KeepStage(const Job& job) {
  std::string stage;
  {
    const std::lock_guard lock(mutex_);
    stage = running_.at(job.id).latest.stage;
  }
  if (stage.empty()) return;
  Persist([&] {
    store_.database.Write(
        [&](Connection& connection) { SetLastStage(connection, job.id, job.attempt, stage); });
  });
}

/// Ends an attempt by `change`, or as cancelled when it was cancelled in its very last moment.
template <typename Change>
void JobRunner::End(const Job& job, const Change& change) {
  const bool is_cancelled = BeginEnd(job);
  KeepStage(job);
  if (is_cancelled) {
    Persist([&] { FinishCancelledJob(store_, job); });
  } else {
    Persist(change);
  }
}

void JobRunner::Announce(const Job& job, const EngineAttempt& attempt) {
  {
    const std::lock_guard lock(mutex_);
    Running& running = running_.at(job.id);
    if (running.waits && !attempt.place().waits) running.started = steady_clock::now();
    running.waits = attempt.place().waits;
    running.latest = attempt.progress();
    running.reason = attempt.reason();
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
