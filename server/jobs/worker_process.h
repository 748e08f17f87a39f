#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/jobs/walls/worker_cgroup.h"
#include "server/jobs/walls/worker_limits.h"

namespace parkade {

/// Where a worker runs, and within which walls.
struct WorkerPlace {
  std::filesystem::path folder;                      ///< its working directory; it may write there
  std::filesystem::path log;                         ///< what it prints is appended here
  std::filesystem::path temporary_files = {};        ///< its TMPDIR; empty: this process's own
  std::vector<std::filesystem::path> writable = {};  ///< more folders that it may write in
  std::filesystem::path hidden = {};                 ///< a folder that it is not to see
  std::vector<std::filesystem::path> visible = {};   ///< what it may read of that all the same
  WorkerLimits limits = {};
  bool says_walls = false;  ///< the log says what the worker is shut off from
  int input = -1;           ///< file descriptor that becomes its standard input; -1: it has none
};

/// A child process that cannot outlive the thread that started it, nor what it started itself. As
/// far as the kernel allows, it writes only where it is told to, reaches no network and no other
/// process, and has limits; its log says which. It writes no core file, is nicer than the service
/// and is the first to go when memory runs out. Use from the thread that created it.
class WorkerProcess {
 public:
  /// Throws Error{kInternal} when it cannot be started. A control group that it cannot join only
  /// leaves a line in its log.
  WorkerProcess(const std::vector<std::string>& command, const WorkerPlace& place);
  /// Kills it, and all that it started, when it still runs.
  ~WorkerProcess();
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;

  /// The leader of its group; see ReadWorkerUsage.
  pid_t pid() const { return pid_; }
  const WorkerLimits& limits() const { return limits_; }
  const WorkerCgroup& cgroup() const { return *cgroup_; }

  /// Waits for the end, at most `patience`. Returns the status of waitpid(2), or
  /// nothing while the process runs. It may be called again after the end.
  std::optional<int> Wait(std::chrono::milliseconds patience);

  /// Sends a signal to the whole group; nothing happens after its end. SIGKILL ends all that it
  /// started, in whatever group.
  void Signal(int signal) const;

 private:
  void Start(const std::vector<std::string>& command, const WorkerPlace& place);
  void AwaitStart(pid_t child, int failure);

  WorkerLimits limits_;
  std::unique_ptr<WorkerCgroup> cgroup_;
  pid_t pid_ = -1;
  int pid_fd_ = -1;
  int status_fd_ = -1;  ///< see WorkerLaunch
  std::optional<int> status_;
};

/// When a process was started, in clock ticks since boot: with the pid it names
/// a process for good. Nothing when there is no such process.
std::optional<std::int64_t> ProcessStartTime(pid_t pid);

}  // namespace parkade
