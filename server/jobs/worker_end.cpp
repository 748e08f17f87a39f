#include "server/jobs/worker_end.h"

#include <sys/wait.h>

#include <csignal>
#include <cstring>

namespace parkade {
namespace {

std::string Sentence(int signal, const std::string& stage) {
  const std::string where = stage.empty() ? "" : " in stage '" + stage + "'";
  if (signal == SIGKILL) return "the worker was killed" + where + ", most likely for want of memory";
  return "the worker crashed" + where + ": " + ::strsignal(signal);
}

}  // namespace

WorkerEnd UnderstandEnd(int status, const WorkerProgress& last_words) {
  if (WIFSIGNALED(status)) return {WorkerEnd::Kind::kCrashed, "crashed", Sentence(WTERMSIG(status), last_words.stage)};
  const int exit_status = WEXITSTATUS(status);
  if (exit_status == 0) return {WorkerEnd::Kind::kDone, "", ""};
  const std::string code = last_words.code.value_or(exit_status == 1 ? "invalid_input" : "internal");
  const std::string silent = "the worker ended with status " + std::to_string(exit_status) + " and gave no reason";
  return {WorkerEnd::Kind::kFailed, code, last_words.error.value_or(silent)};
}

}  // namespace parkade
