#pragma once

namespace parkade {

/// Makes the C library, where it can, keep memory that was let go for what comes next. A map takes
/// and lets go of large pieces all the time: to give them back to the system and to be given them
/// anew, zeroed, takes longer than some of what they are needed for. For processes that end with
/// their work.
void TuneMalloc();

/// Gives back to the system what was let go and nothing has taken since: between stages, and
/// before what takes most in one, so that what was left does not add to what is needed.
void ReleaseIdleMemory();

}  // namespace parkade
