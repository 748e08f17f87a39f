#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "server/jobs/slurm/slurm_job.h"
#include "server/jobs/slurm/slurm_options.h"

namespace parkade {

/// A job, or an array of them, as it is handed over.
struct SlurmSubmission {
  std::filesystem::path script, folder;
  std::string comment;     ///< by which it is known
  int array_size = 0;      ///< elements, numbered from 0; 0: it is no array
  std::string after = {};  ///< number of a job, all of which has to end before; empty: none
};

/// The three commands of Slurm that a service uses. Each throws Error{kInternal} with what the
/// command said when it fails, does not answer in time or answers nonsense. Thread-safe.
class SlurmCommands {
 public:
  explicit SlurmCommands(const SlurmOptions& options) : options_(options) {}

  /// Hands over a job that runs its script in its folder with the node's program and the folder as
  /// its words, and returns its number. Where it throws, Slurm may have taken the job all the same:
  /// it is known by its comment then.
  std::string Submit(const SlurmSubmission& job) const;

  /// All jobs that Slurm knows, also those that ended some minutes ago.
  std::vector<SlurmJob> Queue() const;

  /// Ends jobs. Those that have ended are no error.
  void Cancel(const std::vector<std::string>& ids) const;

 private:
  std::string Run(const std::string& program, std::vector<std::string> arguments) const;

  SlurmOptions options_;
};

/// How often a job is handed over that sbatch refuses with this sentence each time, before it is
/// given up: once where no waiting helps, as for a partition that is not there. Nothing: for ever.
std::optional<int> MaxTries(const std::string& refusal);

}  // namespace parkade
