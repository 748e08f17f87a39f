#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

namespace parkade {

/// What a job may use, and how long a crashed one waits.
struct JobLimits {
  std::chrono::seconds time{24 * 3600};  ///< for one attempt
  /// Without any sign of life: neither progress, nor processor time, nor work of the disk.
  std::chrono::milliseconds hang{20'000};
  std::chrono::milliseconds silence{4 * 3'600'000};  ///< at work, but without progress
  std::int64_t memory_bytes = 0;                     ///< of one worker; 0: DefaultMemoryLimit()
  int tasks = 0;                ///< processes and threads of one worker; 0: WorkerLimits' default
  std::int64_t file_bytes = 0;  ///< of one file that it writes; 0: WorkerLimits' default
  /// Before a crashed worker is started again: after the first crash, the second, ...
  std::vector<std::chrono::milliseconds> crash_pauses = {std::chrono::seconds{10},
                                                         std::chrono::seconds{60}};
};

}  // namespace parkade
