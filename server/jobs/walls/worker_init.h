#pragma once

#include <sys/types.h>

namespace parkade {

/// As fork(2) with flags of clone(2), but for the child of a fork only: what the C library does
/// around its own fork is left out. Async-signal-safe.
pid_t ForkAgain(unsigned long flags);

/// Is the first process of a namespace, which waits for `worker` and whatever else ends there, then
/// writes the worker's status of waitpid(2) to `status` and ends, and with it all that is left. It
/// keeps no other file open and hears no signal but SIGKILL. Async-signal-safe.
[[noreturn]] void WaitAsInit(pid_t worker, int status);

}  // namespace parkade
