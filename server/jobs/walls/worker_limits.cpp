#include "server/jobs/walls/worker_limits.h"

#include <sys/resource.h>

#include <algorithm>
#include <thread>

#include "server/jobs/walls/worker_cgroup.h"

namespace parkade {
namespace {

constexpr std::int64_t kMaxFile = std::int64_t{64} << 30;
constexpr std::int64_t kMinFile = std::int64_t{64} << 20;  // a full disk says so itself
constexpr int kTasks = 512, kTasksPerProcessor = 16;

void Lower(__rlimit_resource resource, std::int64_t value) {
  rlimit limit{};
  if (::getrlimit(resource, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max = std::min(limit.rlim_max, static_cast<rlim_t>(value));
  ::setrlimit(resource, &limit);
}

}  // namespace

WorkerLimits Completed(WorkerLimits limits, std::int64_t free_bytes) {
  if (limits.memory_bytes == 0) limits.memory_bytes = DefaultMemoryLimit();
  if (limits.tasks == 0)
    limits.tasks =
        kTasks + kTasksPerProcessor * static_cast<int>(std::thread::hardware_concurrency());
  if (limits.file_bytes == 0) limits.file_bytes = std::clamp(free_bytes / 2, kMinFile, kMaxFile);
  return limits;
}

void SetResourceLimits(const WorkerLimits& limits, int others) {
  Lower(RLIMIT_CORE, 0);
  Lower(RLIMIT_NOFILE, limits.open_files);
  Lower(RLIMIT_FSIZE, limits.file_bytes);
  Lower(RLIMIT_NPROC, limits.tasks + kSpareTasks + others);
}

}  // namespace parkade
