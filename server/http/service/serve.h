#pragma once

#include "server/http/serve_options.h"

namespace parkade {

/// Serves until SIGTERM or SIGINT, then lets requests under way end, puts running
/// jobs back into the queue and returns 0; or until the disk fails, and returns 75: a supervisor
/// that starts it again finds what was acknowledged. Says "listening on http://HOST:PORT"
/// in the log once it answers. Call from a program's main thread, before it has
/// others. Throws Error{kUsage} for an address that is malformed, taken or not
/// loopback (without allow_public), Error{kConflict} when another service uses
/// the data directory.
int Serve(const ServeOptions& options);

}  // namespace parkade
