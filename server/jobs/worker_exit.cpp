#include "server/jobs/worker_exit.h"

#include <sys/wait.h>

#include <csignal>
#include <cstring>

namespace parkade {
namespace {

std::string Sentence(int signal, const std::string& stage) {
  const std::string where = stage.empty() ? "" : " in stage '" + stage + "'";
  if (signal == SIGKILL)
    return "the worker was killed" + where + ", most likely for want of memory";
  return "the worker crashed" + where + ": " + ::strsignal(signal);
}

/// A worker has more codes than jobs end with.
std::string CodeOfWorker(const std::string& word) {
  if (word == "invalid_input" || word == "usage" || word == "not_found") return "invalid_input";
  return word == "disk_full" ? word : "internal";
}

}  // namespace

const char* JobErrorCode(ErrorCode code) {
  switch (code) {
    case ErrorCode::kInvalidInput:
    case ErrorCode::kUsage:
    case ErrorCode::kNotFound: return "invalid_input";
    case ErrorCode::kDiskFull: return "disk_full";
    case ErrorCode::kConflict:
    case ErrorCode::kInternal: break;
  }
  return "internal";
}

WorkerExit UnderstandEnd(int status, const WorkerProgress& last_words) {
  if (WIFSIGNALED(status))
    return {WorkerExit::Kind::kCrashed, "crashed", Sentence(WTERMSIG(status), last_words.stage)};
  const int exit_status = WEXITSTATUS(status);
  if (exit_status == 0) return {WorkerExit::Kind::kDone, "", ""};
  const std::string code =
      CodeOfWorker(last_words.code.value_or(exit_status == 1 ? "invalid_input" : "internal"));
  const std::string silent =
      "the worker ended with status " + std::to_string(exit_status) + " and gave no reason";
  return {WorkerExit::Kind::kFailed, code, last_words.error.value_or(silent)};
}

}  // namespace parkade
