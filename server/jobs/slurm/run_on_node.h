#pragma once

#include <filesystem>

namespace parkade {

/// Runs the worker of an attempt on a node of Slurm's, as its order says and as a service would:
/// within limits, watched, walled in. For a program of its own, with one thread.
/// How it ended is written beside its products; nothing where Slurm tells it to end, because Slurm
/// knows why. Returns the status to exit with. Throws Error where there is no such attempt (any
/// more), or no job of Slurm's around it (kUsage).
int RunOnNode(const std::filesystem::path& attempt);

}  // namespace parkade
