#include "server/jobs/local_engine.h"

#include <csignal>

namespace parkade {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kInterval{200};  // between looks

/// What would only get worse meanwhile.
bool IsGrowing(WorkerTrouble trouble) {
  return trouble == WorkerTrouble::kOverMemory || trouble == WorkerTrouble::kOverTasks;
}

}  // namespace

LocalAttempt::LocalAttempt(const std::vector<std::string>& command, const Place& place,
                           const JobLimits& limits, milliseconds stop_patience)
    : progress_(place.progress),
      products_(place.products),
      worker_(command, place.worker, limits),
      stop_patience_(stop_patience) {
  const pid_t pid = worker_.process().pid();
  job_place_ = {
      .engine = kLocalEngine, .pid = pid, .pid_started = ProcessStartTime(pid).value_or(0)};
}

AttemptNews LocalAttempt::Look() {
  const std::optional<int> status = worker_.process().Wait(kInterval);
  const bool has_spoken = progress_.Poll();
  if (status) {
    status_ = *status;
    worker_.LookAtEnd(status_);
  } else {
    worker_.Look(has_spoken);
    EndInTime();
  }
  return {.has_ended = status.has_value(), .has_spoken = has_spoken};
}

/// Tells the worker to end where it has to, and ends it where it does not listen.
void LocalAttempt::EndInTime() {
  const steady_clock::time_point now = steady_clock::now();
  if (!kill_time_) {
    if (!is_cancelled_ && worker_.trouble() == WorkerTrouble::kNone) return;
    worker_.process().Signal(SIGTERM);
    kill_time_ = now;
    if (!IsGrowing(worker_.trouble())) *kill_time_ += stop_patience_;
  }
  if (now >= *kill_time_) worker_.process().Signal(SIGKILL);
}

WorkerExit LocalAttempt::Exit() const {
  const WorkerTrouble trouble = worker_.trouble();
  const bool was_ended = kill_time_ && trouble != WorkerTrouble::kNone;
  if (was_ended || trouble == WorkerTrouble::kOverMemory)
    return ExplainTrouble(trouble, worker_.limits(), progress_.latest().stage);
  return UnderstandEnd(status_, progress_.latest(), worker_.WasKilledForMemory());
}

std::unique_ptr<EngineAttempt> LocalEngine::Run(const Job&, const AttemptFolder& folder) {
  const JobSpec& spec = folder.spec();
  const LocalAttempt::Place place{.worker = {.folder = folder.RunFolder(),
                                             .log = folder.LogFile(),
                                             .temporary_files = folder.TemporaryFiles(),
                                             // One folder: links do not lead from one to another.
                                             .writable = {folder.WorkerFolder()},
                                             .hidden = folder.data(),
                                             .visible = InputsOf(spec)},
                                  .products = spec.out,
                                  .progress = spec.progress};
  return std::make_unique<LocalAttempt>(command_(spec), place, limits_, stop_patience_);
}

}  // namespace parkade
