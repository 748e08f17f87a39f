#pragma once

namespace parkade {

/// Gives up the capabilities that root has, for good and for whatever the process starts: it can
/// mount, trace, or make devices no more. What is left lets it read and write files that another
/// user made of the same data directory. Between fork and exec: async-signal-safe.
void DropRights();

}  // namespace parkade
