#pragma once

namespace parkade {

/// The socket of the request that this thread answers, while it does; -1 otherwise. To shut it down
/// wakes the thread from another one.
inline int& CurrentSocket() {
  static thread_local int socket = -1;
  return socket;
}

}  // namespace parkade
