#pragma once

#include <string>
#include <vector>

#include "server/jobs/log_limit.h"
#include "server/jobs/worker_process.h"
#include "server/jobs/worker_watch.h"

namespace parkade {

/// The worker of one attempt within its limits. Memory is limited by a control group where one can
/// be made, and in any case by a look at what the worker uses; its log says which.
class WatchedWorker {
 public:
  /// Throws Error{kInternal} when it cannot be started.
  WatchedWorker(const std::vector<std::string>& command, const WorkerPlace& place,
                const JobLimits& limits);

  WorkerProcess& process() { return process_; }
  const JobLimits& limits() const { return limits_; }

  /// Looks for trouble; call several times a second while it runs.
  void Look(bool has_spoken);
  /// The first that was found.
  WorkerTrouble trouble() const { return trouble_; }

  /// The last look, after its end with `status` of waitpid(2).
  void LookAtEnd(int status);

  /// It was killed, and the kernel says that memory was the reason. After its end.
  bool WasKilledForMemory() const;

 private:
  std::int64_t kills_before_;
  WorkerProcess process_;
  JobLimits limits_;
  WorkerWatch watch_;
  LogLimit log_;
  WorkerTrouble trouble_ = WorkerTrouble::kNone;
};

}  // namespace parkade
