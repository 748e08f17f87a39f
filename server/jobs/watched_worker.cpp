#include "server/jobs/watched_worker.h"

#include <fstream>

#include "server/jobs/process_group.h"

namespace parkade {
namespace {

JobLimits WithMemory(JobLimits limits) {
  if (limits.memory_bytes == 0) limits.memory_bytes = DefaultMemoryLimit();
  return limits;
}

/// Null where there is no right to make one. The log's first line says so.
std::unique_ptr<MemoryCgroup> LimitMemory(std::int64_t bytes, const std::filesystem::path& log) {
  std::unique_ptr<MemoryCgroup> cgroup = MemoryCgroup::Make(bytes);
  std::ofstream(log, std::ios::app)
      << "the service limits memory to " << (bytes >> 20) << " MiB by "
      << (cgroup ? "a control group (version " + std::to_string(cgroup->version()) + ")"
                 : "looking at it several times a second: no control group can be made")
      << std::endl;
  return cgroup;
}

WorkerPlace Walled(WorkerPlace place, const MemoryCgroup* cgroup) {
  if (cgroup) place.cgroup = cgroup->ProcessesFile();
  place.says_walls = true;
  return place;
}

}  // namespace

WatchedWorker::WatchedWorker(const std::vector<std::string>& command, const WorkerPlace& place,
                             const JobLimits& limits)
    : limits_(WithMemory(limits)),
      kills_before_(KernelMemoryKills()),
      cgroup_(LimitMemory(limits_.memory_bytes, place.log)),
      process_(command, Walled(place, cgroup_.get())),
      watch_(limits_, WorkerWatch::Clock::now()),
      log_(place.log) {}

void WatchedWorker::Look(bool has_spoken) {
  log_.Apply();
  if (trouble_ == WorkerTrouble::kNone)
    trouble_ = watch_.Look(ReadGroupUsage(process_.pid()), has_spoken, WorkerWatch::Clock::now());
}

void WatchedWorker::LookAtEnd(int status) {
  log_.Apply();
  const bool is_over_memory =
      status != 0 && cgroup_ && cgroup_->HasKilled() && cgroup_->HasReachedLimit();
  if (trouble_ == WorkerTrouble::kNone && is_over_memory) trouble_ = WorkerTrouble::kOverMemory;
}

bool WatchedWorker::WasKilledForMemory() const {
  return cgroup_ ? cgroup_->HasKilled() : KernelMemoryKills() > kills_before_;
}

}  // namespace parkade
