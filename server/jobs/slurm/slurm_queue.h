#pragma once

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "server/jobs/slurm/slurm_commands.h"

namespace parkade {

/// Looks at Slurm's queue again and again, once for all jobs of a service, and ends those of them
/// that nobody waits for: of attempts that were given up, or handed over twice. Thread-safe.
class SlurmQueue {
 public:
  using Clock = std::chrono::steady_clock;

  struct Look {
    Clock::time_point begun;               ///< what was so before is in it
    std::map<std::string, SlurmJob> jobs;  ///< the service's own, by number
    std::string trouble;                   ///< why there is no newer one; the rest is old then
  };

  /// `folder`: jobs whose working directory lies in it are the service's own. `is_wanted`: whether
  /// an attempt, named by its comment, may still run.
  SlurmQueue(const SlurmCommands& commands, std::chrono::milliseconds interval,
             std::filesystem::path folder,
             std::function<bool(const std::string& comment)> is_wanted);
  ~SlurmQueue();
  SlurmQueue(const SlurmQueue&) = delete;
  SlurmQueue& operator=(const SlurmQueue&) = delete;

  /// Somebody waits for the job with this comment, and with this number once it has one ("").
  void Follow(const std::string& comment, const std::string& id);
  void Forget(const std::string& comment);

  /// The latest look, after waiting for one that is not `seen`, `patience` at most. Never null.
  std::shared_ptr<const Look> Wait(const std::shared_ptr<const Look>& seen,
                                   std::chrono::milliseconds patience);

  /// Ends a job and looks soon. What Slurm says against it is in the log only.
  void Cancel(const std::string& id);

 private:
  void Run();
  void LookNow();
  void EndStrays(const Look& look);
  bool IsStray(const SlurmJob& job);

  const SlurmCommands& commands_;
  const std::chrono::milliseconds interval_;
  const std::string folder_;
  const std::function<bool(const std::string& comment)> is_wanted_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::shared_ptr<const Look> latest_ = std::make_shared<Look>();
  std::map<std::string, std::string> followed_;           ///< comment -> number, "" without
  std::map<std::string, Clock::time_point> stray_since_;  ///< by number; of the thread alone
  Clock::time_point due_;
  bool is_stopping_ = false;
  std::thread thread_;
};

}  // namespace parkade
