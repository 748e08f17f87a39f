#pragma once

#include <chrono>

#include "server/jobs/job_limits.h"
#include "server/jobs/process_group.h"

namespace parkade {

/// Why a worker has to be ended.
enum class WorkerTrouble {
  kNone,
  kHangs,       ///< no sign of life for JobLimits::hang
  kIsSilent,    ///< at work, without progress for JobLimits::silence
  kIsLate,      ///< not done after JobLimits::time
  kOverMemory,  ///< more than JobLimits::memory_bytes
  kOverTasks,   ///< as many processes as JobLimits::tasks, or more
};

/// Tells a worker that hangs from one that is slow. Signs of life come from the work itself:
/// progress, processor time, bytes of a disk, a thread that waits for either.
class WorkerWatch {
 public:
  using Clock = std::chrono::steady_clock;

  WorkerWatch(const JobLimits& limits, Clock::time_point start)
      : limits_(limits), start_(start), last_(start) {}

  /// Call several times a second. `has_spoken`: there was progress since the last look. Time
  /// without looks, as when the service itself was stopped, counts as one second at most.
  WorkerTrouble Look(const GroupUsage& usage, bool has_spoken, Clock::time_point now);

 private:
  bool IsAlive(const GroupUsage& usage) const;

  JobLimits limits_;
  Clock::time_point start_, last_;
  GroupUsage at_life_;  ///< at the last sign of life
  Clock::duration idle_{0}, silent_{0};
};

}  // namespace parkade
