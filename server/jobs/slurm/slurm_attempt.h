#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "server/jobs/job_engine.h"
#include "server/jobs/slurm/slurm_preparation.h"
#include "server/jobs/slurm/slurm_queue.h"

namespace parkade {

/// An attempt whose worker is a job of Slurm's. It goes on when this object is gone.
///
/// Its folder is the authority on how it ended; where that has no word, Slurm's state says why. A
/// job that Slurm does not take, or not answer for, is handed over again until it does: before
/// that, a look at the queue says whether it has not been taken after all. One that Slurm will
/// never take fails.
class SlurmAttempt : public EngineAttempt {
 public:
  /// The order, with so many preparations, and the script lie in `folder`. `place`: where an
  /// earlier service left it.
  SlurmAttempt(const SlurmCommands& commands, SlurmQueue& queue,
               std::chrono::milliseconds exit_patience, std::filesystem::path folder,
               std::string comment, int num_preparations, const std::optional<JobPlace>& place);
  ~SlurmAttempt() override;

  AttemptNews Look() override;
  JobPlace place() const override { return place_; }
  std::string reason() const override { return reason_; }
  const WorkerProgress& progress() const override { return latest_; }
  void Cancel() override;
  WorkerExit Exit() const override { return end_->exit; }
  std::filesystem::path products() const override { return end_->products; }

 private:
  using Clock = SlurmQueue::Clock;
  struct End {
    WorkerExit exit;
    std::filesystem::path products;
  };

  void HandOver();
  void Submit();
  void SetId(const std::string& id);
  std::optional<End> FindEnd();
  std::optional<WorkerExit> AskSlurm();
  std::optional<WorkerExit> Understand(const SlurmJob& job);
  std::optional<WorkerExit> GiveUp(const SlurmJob& job);
  std::optional<WorkerExit> AfterPatience(const WorkerExit& exit);
  bool ReadProgress();
  bool ReadRun();

  const SlurmCommands& commands_;
  SlurmQueue& queue_;
  const std::chrono::milliseconds exit_patience_;
  const std::filesystem::path folder_;
  const std::string comment_;

  SlurmPreparation preparation_;
  const double prepared_share_;  ///< of the whole work, that the preparation does
  JobPlace place_;
  std::string reason_;
  WorkerProgress latest_;
  std::shared_ptr<const SlurmQueue::Look> look_;
  std::optional<Clock::time_point> unsure_since_;  ///< Slurm may have taken it all the same
  std::string refusal_;                            ///< what sbatch said last
  int refusals_ = 0;                               ///< in a row, with this sentence
  bool is_refused_ = false;                        ///< for good
  Clock::time_point next_try_;
  std::chrono::milliseconds pause_{1000};          ///< before the try after the next
  Clock::time_point known_since_;                  ///< from when on Slurm's queue has to have it
  std::optional<Clock::time_point> silent_since_;  ///< it has ended, or is unknown, without a word
  std::optional<Clock::time_point> cancelled_;
  int restarts_ = 0;
  std::optional<ProgressReader> run_;  ///< the latest one's progress
  std::optional<End> end_;
};

}  // namespace parkade
