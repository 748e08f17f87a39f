#pragma once

#include <string>

#include "core/error.h"
#include "server/jobs/progress_reader.h"
#include "server/jobs/worker_watch.h"

namespace parkade {

/// How a worker's end is to be understood.
struct WorkerExit {
  enum class Kind {
    kDone,
    kFailed,     ///< trying again would give the same
    kCrashed,    ///< ended by a signal: worth another try
    kCancelled,  ///< by somebody at the engine
    kReturned,   ///< ended through no fault of its own: to be tried again
  };
  Kind kind = Kind::kDone;
  /// "invalid_input", "disk_full", "out_of_memory", "time_limit", "internal", "crashed"
  std::string code;
  std::string sentence;  ///< for the user
};

/// The `error_code` of a job that ended by an error: one of those above. A job that misses
/// something or is told something wrong has a bad input; a conflict is our fault.
const char* JobErrorCode(ErrorCode code);

/// `status` as given by waitpid(2), `last_words` as read from its progress file;
/// `is_killed_for_memory`: by what the kernel says.
WorkerExit UnderstandEnd(int status, const WorkerProgress& last_words, bool is_killed_for_memory);

/// Explains the end of a worker for `trouble`, which is not kNone, in stage `stage`.
WorkerExit ExplainTrouble(WorkerTrouble trouble, const JobLimits& limits, const std::string& stage);

}  // namespace parkade
