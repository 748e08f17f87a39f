#include "server/jobs/slurm/slurm_options.h"

#include <algorithm>
#include <cctype>

#include "core/error.h"

namespace parkade {

void CheckSlurmOptions(const SlurmOptions& options) {
  const bool is_name = std::all_of(
      options.partition.begin(), options.partition.end(),
      [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.'; });
  Require(is_name && !options.partition.starts_with('-'), ErrorCode::kUsage,
          "'" + options.partition + "' is not the name of a partition");
  Require(options.cpus >= 1, ErrorCode::kUsage, "a job needs at least one processor");
  Require(options.memory_mib > 0, ErrorCode::kUsage,
          "Slurm has to know how much memory a job may use: say --job-memory");
  Require(options.time.count() > 0, ErrorCode::kUsage,
          "Slurm has to know how long a job may take: say --job-time");
  Require(!options.node_program.empty(), ErrorCode::kInternal, "there is no program for the nodes");
}

}  // namespace parkade
