#pragma once

#include <string>
#include <vector>

#include "server/jobs/worker_exit.h"

namespace parkade {

/// A job as Slurm's queue shows it.
struct SlurmJob {
  std::string id = {};        ///< digits
  std::string array_id = {};  ///< number of the array that it is an element of; "0": none
  std::string comment = {};
  std::string folder = {};           ///< its working directory
  std::string state = {};            ///< "PENDING", "RUNNING", ...
  std::string reason = {};           ///< why it waits; may be empty
  bool has_failed_to_start = false;  ///< on its node; Slurm holds it until somebody releases it
  int restarts = 0;                  ///< how often Slurm has put it back into its queue
  int status = 0;                    ///< of waitpid(2), once it has ended
};

/// Slurm's states, by what they mean for whoever waits for a job. One that is about to end has not.
enum class SlurmPhase { kWaiting, kRunning, kEnded };
SlurmPhase PhaseOf(const SlurmJob& job);

/// Understands `squeue --json` of Slurm 22.05 and later. Throws Error{kInternal} for anything else;
/// a job without a number is left out.
std::vector<SlurmJob> ParseSlurmQueue(const std::string& json);

/// The job's number in what `sbatch --parsable` says. Throws Error{kInternal} where there is none.
std::string ParseSlurmId(const std::string& output);

/// The end of a job that left no word itself, in stage `stage`.
WorkerExit ExplainSlurmEnd(const SlurmJob& job, const std::string& stage);

}  // namespace parkade
