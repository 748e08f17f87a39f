#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace parkade {

/// What a program took of the machine.
struct ProgramCost {
  int exit_status = 0;
  double seconds = 0, processor_seconds = 0;
  std::int64_t peak_memory_bytes = 0;
  std::optional<std::int64_t> instructions;  ///< where the machine counts them
};

/// Runs `command`, a program and its arguments, to its end; its output goes to where ours goes.
/// Throws Error{kInternal} where it cannot be started.
ProgramCost RunProgram(const std::vector<std::string>& command);

}  // namespace parkade
