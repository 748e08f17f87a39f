#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "server/jobs/job_limits.h"
#include "server/jobs/worker_exit.h"

namespace parkade {

// What a service and a node tell each other, in the folder of an attempt that both see:
//
//   runs/order.json        what the node is to do
//   runs/run.sh            what Slurm starts: runs its words
//   runs/<run>/            one start of the worker; its working directory
//     out/, tmp/, progress.ndjson
//     exit.json            how it ended; there once it has, and whole
//   runs/prepare/          where drives are prepared, before or instead of a run
//     <n>.ndjson, <n>.txt  of the drive of the n-th preparation: progress, and what was printed
//     <n>-<run>/           one start of its worker; its working directory
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

/// The folder of the run that Slurm calls by this number, restarted so often.
std::filesystem::path RunFolder(const std::filesystem::path& attempt, const std::string& slurm_id,
                                int restarts);

/// A preparation, by its number from 0: its progress, what it prints, and the folder of its run.
std::filesystem::path PreparationProgress(const std::filesystem::path& attempt, int number);
std::filesystem::path PreparationLog(const std::filesystem::path& attempt, int number);
std::filesystem::path PreparationFolder(const std::filesystem::path& attempt, int number,
                                        const std::string& slurm_id, int restarts);

/// Durable when it returns. Throws as WriteFileAtomically does.
void WriteNodeExit(const std::filesystem::path& run, const WorkerExit& exit);

struct NodeExit {
  std::filesystem::path run;
  WorkerExit exit;
};
/// A run of the attempt that has ended, if any.
std::optional<NodeExit> FindNodeExit(const std::filesystem::path& attempt);

}  // namespace parkade
