#pragma once

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "server/jobs/event_hub.h"
#include "server/jobs/job_limits.h"
#include "server/jobs/job_spec.h"
#include "server/jobs/progress_reader.h"
#include "server/jobs/watched_worker.h"
#include "server/store/store.h"
#include "server/store/tables/records.h"

namespace parkade {

struct JobRunnerOptions {
  JobCommand command;                             ///< required
  int num_workers = 1;                            ///< worker processes at a time
  std::chrono::milliseconds stop_patience{5000};  ///< between SIGTERM and SIGKILL
  JobLimits limits;
};

/// How far a running job is.
struct JobProgress {
  std::string stage;
  double progress = 0;                ///< 0 to 1
  std::optional<double> eta_seconds;  ///< [s] left, from the worker or from the pace so far
};

/// Takes jobs from the queue of the store, runs each in a worker process and
/// publishes what it made. A job can crash its worker, never the service: a
/// crashed worker is started again, at most kMaxCrashes times in all. Jobs that a
/// service was at when it died are queued again by the next one. Thread-safe.
class JobRunner {
 public:
  /// Puts jobs back into the queue that an earlier service left running, and
  /// starts working.
  JobRunner(Store& store, EventHub& events, JobRunnerOptions options);
  ~JobRunner();
  JobRunner(const JobRunner&) = delete;
  JobRunner& operator=(const JobRunner&) = delete;

  /// Says that the queue has grown.
  void Wake();

  /// Cancels a queued or running job. Throws Error{kNotFound}, Error{kConflict}
  /// when it has ended or its end is already being stored.
  void Cancel(const std::string& job_id);

  std::optional<JobProgress> ProgressOf(const std::string& job_id) const;

  /// Ends the workers and puts their jobs back into the queue. Final.
  void Stop();

 private:
  struct Running {
    int attempt = 1;
    WorkerProgress latest;
    std::chrono::steady_clock::time_point started;
    bool is_cancelled = false;
    bool is_ending = false;  ///< too late to cancel it
  };
  enum class Interruption { kNone, kCancelled, kStopped, kTrouble };

  bool RecoverJobs();
  void Work();
  void RunAttempt(const Job& job);
  void RunWorker(const Job& job);
  void CheckLogs(const Job& job);
  std::chrono::milliseconds PauseAfter(const Job& crashed) const;
  void Publish(const Job& job, const std::filesystem::path& products);
  Interruption Supervise(const Job& job, WatchedWorker& worker, ProgressReader& progress);
  Interruption Interrupted(const Job& job, WorkerTrouble trouble) const;
  bool BeginEnd(const Job& job);
  template <typename Change>
  void End(const Job& job, const Change& change);
  void Announce(const Job& job, const WorkerProgress& latest);
  void PublishStates(const Job& job);
  template <typename Change>
  void Persist(const Change& change);

  Store& store_;
  EventHub& events_;
  const JobRunnerOptions options_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::string, Running> running_;
  std::mutex recovery_mutex_;
  std::vector<Job> left_over_;  ///< jobs that an earlier service left running
  bool is_stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace parkade
