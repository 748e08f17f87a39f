#pragma once

#include <sys/types.h>

#include <cstdint>

namespace parkade {

/// What the living processes of a group use, from /proc.
struct GroupUsage {
  std::int64_t memory_bytes = 0;  ///< resident, without pages of files: those can be dropped
  double processor_seconds = 0;   ///< so far, with children that have ended
  std::int64_t disk_bytes = 0;    ///< read from and written to disks so far
  bool is_busy = false;  ///< a thread runs, waits for a processor, or for a disk (state R or D)
};

/// Nothing used where there is no such group.
GroupUsage ReadGroupUsage(pid_t group);

}  // namespace parkade
