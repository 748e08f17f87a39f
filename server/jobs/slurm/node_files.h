#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "server/jobs/job_limits.h"
#include "server/jobs/worker_exit.h"

namespace parkade {

// What a service and a node tell each other, in the folders of a job that both see. No worker
// writes in the attempt's:
//
//   attempt-<n>/runs/order.json         what the node is to do
//   attempt-<n>/runs/run.sh             what Slurm starts: runs its words
//   attempt-<n>/runs/<run>.exit.json    how a run ended; there once it has, and whole
//   attempt-<n>/runs/prepare-<i>.txt    what the i-th preparation printed
//
// <run> is "attempt-<n>-<Slurm's number>-<restarts>", one start of the worker. All workers of the
// job write in one folder (server/jobs/attempt_folder.h):
//
//   worker/<run>/                       its working directory: out/, tmp/, progress.ndjson
//   worker/attempt-<n>-prepare-<i>-.../ the same where a drive is prepared, before a run
//   worker/attempt-<n>-prepare-<i>.ndjson   its progress
//
// All goes when the attempt has ended: whoever comes later finds no order and does nothing.
//
// Slurm may start a job again while its first run still lives, on a node that it does not hear of
// any more: each run writes into a folder of its own, and the first that ends gives the attempt its
// end.

/// What a node is to run, and within which limits.
struct NodeOrder {
  /// Paths for products, progress and preview in it are relative to the run's folder, or absolute.
  std::vector<std::string> command;
  JobLimits limits;
  std::filesystem::path data = {};                  ///< the data directory, which it is not to see
  std::vector<std::filesystem::path> visible = {};  ///< what it only reads of that
  /// Commands of workers that prepare one drive each, on any nodes, before the command runs.
  std::vector<std::vector<std::string>> preparations = {};
};

/// Makes the folder of the runs, too. Throws as WriteFileAtomically does.
void WriteNodeOrder(const std::filesystem::path& attempt, const NodeOrder& order);
/// Throws Error{kNotFound}, Error{kInternal} for nonsense.
NodeOrder ReadNodeOrder(const std::filesystem::path& attempt);

/// Writes the script. No word of a user is in it.
void WriteNodeScript(const std::filesystem::path& attempt);
std::filesystem::path NodeScript(const std::filesystem::path& attempt);

/// The one folder that the workers of the attempt's job may write in.
std::filesystem::path WorkerFolder(const std::filesystem::path& attempt);

/// The folder of the run that Slurm calls by this number, restarted so often.
std::filesystem::path RunFolder(const std::filesystem::path& attempt, const std::string& slurm_id,
                                int restarts);

/// A preparation, by its number from 0: its progress, what it prints, and the folder of its run.
std::filesystem::path PreparationProgress(const std::filesystem::path& attempt, int number);
std::filesystem::path PreparationLog(const std::filesystem::path& attempt, int number);
std::filesystem::path PreparationFolder(const std::filesystem::path& attempt, int number,
                                        const std::string& slurm_id, int restarts);

/// Durable when it returns. Throws as WriteFileAtomically does.
void WriteNodeExit(const std::filesystem::path& attempt, const std::filesystem::path& run,
                   const WorkerExit& exit);

struct NodeExit {
  std::filesystem::path run;
  WorkerExit exit;
};
/// A run of the attempt that has ended, if any.
std::optional<NodeExit> FindNodeExit(const std::filesystem::path& attempt);

}  // namespace parkade
