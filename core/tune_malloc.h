#pragma once

namespace parkade {

/// Makes the C library, where it can, keep memory that was let go for what comes next. A map takes
/// and lets go of large pieces all the time: to give them back to the system and to be given them
/// anew, zeroed, takes longer than some of what they are needed for. For processes that end with
/// their work.
void TuneMalloc();

/// Starts the program again, once, with malloc's memory in pages of 2 MB where the system gives
/// them to who asks (madvise): each first touch of one of 4 KB is dear on virtual machines, and
/// malloc reads this setting (a tunable of glibc) only as it starts. Call it first of all. Returns
/// where there is nothing to gain, or the program cannot be started again. \param arguments  of
/// main, the last one null
void UseHugePages(char* const* arguments);

/// Gives back to the system what was let go and nothing has taken since: between stages, and
/// before what takes most in one, so that what was left does not add to what is needed.
void ReleaseIdleMemory();

}  // namespace parkade
