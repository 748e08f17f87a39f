#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "server/jobs/job_engine.h"
#include "server/jobs/job_limits.h"
#include "server/jobs/job_spec.h"
#include "server/jobs/watched_worker.h"

namespace parkade {

/// A worker as a child of this process, within its limits.
class LocalAttempt : public EngineAttempt {
 public:
  struct Place {
    WorkerPlace worker;
    std::filesystem::path products, progress;  ///< as JobSpec::out, JobSpec::progress
  };

  /// Throws Error{kInternal} when it cannot be started.
  LocalAttempt(const std::vector<std::string>& command, const Place& place, const JobLimits& limits,
               std::chrono::milliseconds stop_patience);

  AttemptNews Look() override;
  JobPlace place() const override { return job_place_; }
  const WorkerProgress& progress() const override { return progress_.latest(); }
  void Cancel() override { is_cancelled_ = true; }
  WorkerExit Exit() const override;
  std::filesystem::path products() const override { return products_; }

 private:
  void EndInTime();

  ProgressReader progress_;
  std::filesystem::path products_;
  WatchedWorker worker_;
  const std::chrono::milliseconds stop_patience_;
  JobPlace job_place_;
  bool is_cancelled_ = false;
  std::optional<std::chrono::steady_clock::time_point> kill_time_;  ///< once it was told to end
  int status_ = 0;                                                  ///< of waitpid(2)
};

/// Runs workers as child processes of the service.
class LocalEngine : public JobEngine {
 public:
  /// `stop_patience` passes between SIGTERM and SIGKILL.
  LocalEngine(JobCommand command, JobLimits limits, std::chrono::milliseconds stop_patience)
      : command_(std::move(command)), limits_(std::move(limits)), stop_patience_(stop_patience) {}

  std::string name() const override { return kLocalEngine; }
  EngineCapabilities capabilities() const override { return {}; }
  std::unique_ptr<EngineAttempt> Run(const Job& job, const AttemptFolder& folder) override;

 private:
  const JobCommand command_;
  const JobLimits limits_;
  const std::chrono::milliseconds stop_patience_;
};

}  // namespace parkade
