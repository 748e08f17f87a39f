#pragma once

namespace parkade {

/// Shuts the calling process, and what it starts, off from every network: a log that takes a worker
/// over can send nothing away. Before exec, after fork: async-signal-safe. Returns 0, or the error
/// of errno(3) where the kernel does not allow it. It clears PR_SET_PDEATHSIG.
int LeaveNetwork();

}  // namespace parkade
