#pragma once

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "server/jobs/event_hub.h"
#include "server/jobs/job_engine.h"
#include "server/jobs/job_limits.h"
#include "server/jobs/job_spec.h"
#include "server/jobs/left_over_jobs.h"
#include "server/jobs/progress_reader.h"
#include "server/store/store.h"
#include "server/store/tables/records.h"

namespace parkade {

struct JobRunnerOptions {
  JobCommand command;                             ///< required by the local engine
  int num_workers = 1;                            ///< jobs that the engine has at a time
  std::chrono::milliseconds stop_patience{5000};  ///< between SIGTERM and SIGKILL
  JobLimits limits;
  std::shared_ptr<JobEngine> engine = {};  ///< none: a LocalEngine with what stands above
};

/// How far a running job is.
struct JobProgress {
  std::string stage;
  double progress = 0;                ///< 0 to 1
  std::optional<double> eta_seconds;  ///< [s] left, from the worker or from the pace so far
  std::string reason;                 ///< why it waits with the engine, in the engine's words
};

/// Takes jobs from the queue of the store, has an engine run each in a worker process and publishes
/// what it made. A job can crash its worker, never the service: a crashed worker is started again,
/// at most kMaxCrashes times in all. Jobs that a service was at when it died are queued again by
/// the next one, or taken up where the engine goes on with them. Thread-safe.
class JobRunner {
 public:
  /// Takes up the jobs that an earlier service left running, or puts them back into the queue, and
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

  /// Ends the workers and puts their jobs back into the queue; an engine that goes on keeps them.
  /// Final.
  void Stop();

 private:
  struct Running {
    int attempt = 1;
    WorkerProgress latest;
    bool waits = false;  ///< in the queue of the engine
    std::string reason;  ///< why
    std::chrono::steady_clock::time_point started;
    bool is_cancelled = false;
    bool is_ending = false;  ///< too late to cancel it
  };
  enum class Interruption { kNone, kCancelled, kStopped };

  std::optional<Job> NextJob(bool claims);
  void Work(bool claims);
  void RunAttempt(const Job& job);
  void RunWorker(const Job& job);
  std::chrono::milliseconds PauseAfter(const Job& crashed) const;
  void Publish(const Job& job, const std::filesystem::path& products);
  void EndBy(const Job& job, const AttemptFolder& folder, const EngineAttempt& attempt);
  Interruption Supervise(const Job& job, EngineAttempt& attempt);
  Interruption Interrupted(const Job& job) const;
  bool StorePlace(const Job& job, const JobPlace& place);
  bool BeginEnd(const Job& job);
  void KeepStage(const Job& job);
  template <typename Change>
  void End(const Job& job, const Change& change);
  void Announce(const Job& job, const EngineAttempt& attempt);
  void PublishStates(const Job& job);
  template <typename Change>
  void Persist(const Change& change);

  Store& store_;
  EventHub& events_;
  const JobRunnerOptions options_;
  const std::shared_ptr<JobEngine> engine_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::string, Running> running_;
  LeftOverJobs left_over_;
  bool is_stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace parkade
