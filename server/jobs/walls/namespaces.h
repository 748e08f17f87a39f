#pragma once

namespace parkade {

/// Takes the calling process out of the network (CLONE_NEWNET), of reach of other processes
/// (CLONE_NEWPID, for what it starts from then on, the first of which ends the others with itself)
/// and of shared memory (CLONE_NEWIPC), as far as the kernel allows it. Who is not root gets there
/// by a user namespace (CLONE_NEWUSER), as whom it was before. Returns the flags of where it is
/// now. Between fork and exec: async-signal-safe. It clears PR_SET_PDEATHSIG.
int LeaveOthers();

}  // namespace parkade
