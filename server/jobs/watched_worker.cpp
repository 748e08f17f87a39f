#include "server/jobs/watched_worker.h"

#include "server/jobs/process_group.h"

namespace parkade {
namespace {

WorkerPlace Limited(WorkerPlace place, const JobLimits& limits) {
  place.limits.memory_bytes = limits.memory_bytes;
  place.limits.tasks = limits.tasks;
  place.limits.file_bytes = limits.file_bytes;
  place.says_walls = true;
  return place;
}

JobLimits Completed(JobLimits limits, const WorkerLimits& of_worker) {
  limits.memory_bytes = of_worker.memory_bytes;
  limits.tasks = of_worker.tasks;
  limits.file_bytes = of_worker.file_bytes;
  return limits;
}

}  // namespace

WatchedWorker::WatchedWorker(const std::vector<std::string>& command, const WorkerPlace& place,
                             const JobLimits& limits)
    : kills_before_(KernelMemoryKills()),
      process_(command, Limited(place, limits)),
      limits_(Completed(limits, process_.limits())),
      watch_(limits_, WorkerWatch::Clock::now()),
      log_(place.log) {}

void WatchedWorker::Look(bool has_spoken) {
  log_.Apply();
  if (trouble_ == WorkerTrouble::kNone)
    trouble_ = watch_.Look(ReadWorkerUsage(process_.pid()), has_spoken, WorkerWatch::Clock::now());
}

void WatchedWorker::LookAtEnd(int status) {
  log_.Apply();
  const bool is_over_memory =
      status != 0 && process_.cgroup().HasKilled() && process_.cgroup().HasReachedLimit();
  if (trouble_ == WorkerTrouble::kNone && is_over_memory) trouble_ = WorkerTrouble::kOverMemory;
}

bool WatchedWorker::WasKilledForMemory() const {
  return process_.cgroup().memory_version() ? process_.cgroup().HasKilled()
                                            : KernelMemoryKills() > kills_before_;
}

}  // namespace parkade
