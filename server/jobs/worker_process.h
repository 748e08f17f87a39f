#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace parkade {

/// Where a worker runs.
struct WorkerPlace {
  std::filesystem::path folder;                ///< its working directory
  std::filesystem::path log;                   ///< what it prints is appended here
  std::filesystem::path temporary_files = {};  ///< its TMPDIR; empty: this process's own
  std::filesystem::path cgroup = {};           ///< file to join a control group by; empty: none
  bool says_walls = false;                     ///< the log says what the worker is shut off from
  int input = -1;  ///< file descriptor that becomes its standard input; -1: it has none
};

/// A child process in a group of its own that cannot outlive the thread that
/// started it, reaches no network where the kernel allows that, writes no core file, is nicer than
/// the service and is the first to go when memory runs out. Use from the thread that created it.
class WorkerProcess {
 public:
  /// Throws Error{kInternal} when it cannot be started. A control group that it cannot join only
  /// leaves a line in its log.
  WorkerProcess(const std::vector<std::string>& command, const WorkerPlace& place);
  /// Kills the group when it still runs.
  ~WorkerProcess();
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;

  pid_t pid() const { return pid_; }

  /// Waits for the end, at most `patience`. Returns the status of waitpid(2), or
  /// nothing while the process runs. It may be called again after the end.
  std::optional<int> Wait(std::chrono::milliseconds patience);

  /// Sends a signal to the whole group; nothing happens after its end.
  void Signal(int signal) const;

 private:
  pid_t pid_ = -1;
  int pid_fd_ = -1;
  std::optional<int> status_;
};

/// When a process was started, in clock ticks since boot: with the pid it names
/// a process for good. Nothing when there is no such process.
std::optional<std::int64_t> ProcessStartTime(pid_t pid);

}  // namespace parkade
