#pragma once

#include <cstdint>

namespace parkade {

/// What one worker may use.
struct WorkerLimits {
  std::int64_t memory_bytes = 0;  ///< 0: DefaultMemoryLimit()
  int tasks = 0;                  ///< processes and threads; 0: enough for some per processor
  int open_files = 4096;
  std::int64_t file_bytes = 0;  ///< of one file; 0: 64 GiB, or half of the free disk
};

/// The kernel allows so many more than WorkerLimits::tasks, so that whoever looks sees that the
/// limit was reached.
constexpr int kSpareTasks = 16;

/// The same limits without a 0. `free_bytes`: on the disk of the worker's folder.
WorkerLimits Completed(WorkerLimits limits, std::int64_t free_bytes);

/// Sets those limits that take no control group, for the calling process and what it starts.
/// `others`: processes and threads of its user that the kernel counts besides.
/// Async-signal-safe.
void SetResourceLimits(const WorkerLimits& limits, int others);

}  // namespace parkade
