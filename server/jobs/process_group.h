#pragma once

#include <sys/types.h>

#include <cstdint>

namespace parkade {

/// What living processes use, from /proc.
struct GroupUsage {
  std::int64_t memory_bytes = 0;  ///< resident, without pages of files: those can be dropped
  double processor_seconds = 0;   ///< so far, with children that have ended
  std::int64_t disk_bytes = 0;    ///< read from and written to disks so far
  bool is_busy = false;  ///< a thread runs, waits for a processor, or for a disk (state R or D)
  int tasks = 0;         ///< processes and threads
};

/// Sums up what the worker with this leader (WorkerProcess::pid) uses: its group, and where the
/// leader is the init process of a namespace, whatever else is in there, but not the leader itself.
/// Nothing is used where there is no such process.
GroupUsage ReadWorkerUsage(pid_t leader);

/// Processes and threads of a user.
int CountTasksOf(uid_t user);

}  // namespace parkade
