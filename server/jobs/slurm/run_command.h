#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace parkade {

/// What a command said, and how it ended.
struct CommandResult {
  int status = 0;      ///< of waitpid(2)
  std::string output;  ///< on standard output
  std::string errors;  ///< on standard error, its beginning
};

/// Runs a program, found by PATH where its name has no slash, without a shell. Of this process's
/// environment it gets what finds programs, homes and languages, and what is Slurm's. Throws
/// Error{kInternal} when it cannot be started, takes longer than `patience` or says more than
/// `max_bytes`; it is killed then.
CommandResult RunCommand(const std::vector<std::string>& command,
                         std::chrono::milliseconds patience,
                         std::size_t max_bytes = std::size_t{256} << 20);

}  // namespace parkade
