#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace parkade {

/// What a service asks of Slurm for each job, and how it talks to it.
struct SlurmOptions {
  std::string partition = {};   ///< letters, digits, "_", "-", "."; empty: the cluster's own choice
  int cpus = 2;                 ///< of one job
  std::int64_t memory_mib = 0;  ///< [MiB] of one job; required
  std::chrono::minutes time{0};  ///< of one run of a job; required
  /// The program that runs a worker on a node (RunOnNode), and its words before the folder. It has
  /// that name on every node, as the data directory does.
  std::vector<std::string> node_program = {};
  std::filesystem::path commands = {};  ///< folder of sbatch, squeue, scancel; empty: those of PATH

  std::chrono::milliseconds poll_interval{2'000};      ///< between two looks at the queue
  std::chrono::milliseconds command_patience{20'000};  ///< for one command
  /// For the last words of a job that ended, which a shared disk may show late.
  std::chrono::milliseconds exit_patience{15'000};
};

/// Throws Error{kUsage} for what is missing or out of range.
void CheckSlurmOptions(const SlurmOptions& options);

}  // namespace parkade
