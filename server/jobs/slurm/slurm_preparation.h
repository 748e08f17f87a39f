#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "server/jobs/progress_reader.h"
#include "server/jobs/slurm/slurm_commands.h"
#include "server/jobs/slurm/slurm_queue.h"

namespace parkade {

/// What stands behind the comment of an attempt in that of its array.
inline const std::string kPreparationMark = "-prepare";

/// The array of an attempt at Slurm, whose elements prepare one drive each, beside each other. The
/// attempt's own job waits for the end of all and does what they left: it needs none of them.
class SlurmPreparation {
 public:
  /// `count` drives; 0: there is none. `folder` and `comment` of the attempt.
  SlurmPreparation(const SlurmCommands& commands, SlurmQueue& queue, std::filesystem::path folder,
                   const std::string& comment, int count);
  ~SlurmPreparation();
  SlurmPreparation(const SlurmPreparation&) = delete;
  SlurmPreparation& operator=(const SlurmPreparation&) = delete;

  /// Hands the array over unless Slurm has it by this look, and returns the number of the job to
  /// wait for: empty where there is nothing to wait for, also because Slurm refused it.
  std::string Begin(const SlurmQueue::Look* look);

  /// Ends elements that Slurm would keep for ever. True while an element runs.
  bool Tend(const SlurmQueue::Look& look);
  /// Why elements wait, in Slurm's words, while none runs.
  const std::string& reason() const { return reason_; }

  void Cancel(const SlurmQueue::Look* look);

  /// Reads what the elements say. True when that changed anything.
  bool ReadProgress();
  /// Mean of all elements, 0 to 1.
  double progress() const;

 private:
  std::vector<SlurmJob> Elements(const SlurmQueue::Look& look) const;

  const SlurmCommands& commands_;
  SlurmQueue& queue_;
  const std::filesystem::path folder_;
  const std::string comment_;
  const int count_;

  std::string id_;
  std::optional<SlurmQueue::Clock::time_point> begun_;
  std::string reason_;
  std::vector<ProgressReader> progress_;
};

}  // namespace parkade
