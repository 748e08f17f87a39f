#include "server/jobs/worker_exit.h"

#include <sys/wait.h>

#include <csignal>
#include <cstring>

#include "server/jobs/job_spec.h"

namespace parkade {
namespace {

std::string Place(const std::string& stage) {
  return stage.empty() ? "" : " in stage '" + stage + "'";
}

std::string Seconds(std::chrono::milliseconds time) {
  return std::to_string(std::chrono::duration_cast<std::chrono::seconds>(time).count()) +
         " seconds";
}

/// A worker has more codes than jobs end with.
std::string CodeOfWorker(const std::string& word) {
  if (word == "invalid_input" || word == "usage" || word == "not_found") return "invalid_input";
  return word == "disk_full" || word == "out_of_memory" ? word : "internal";
}

}  // namespace

const char* JobErrorCode(ErrorCode code) {
  switch (code) {
    case ErrorCode::kInvalidInput:
    case ErrorCode::kUsage:
    case ErrorCode::kNotFound: return "invalid_input";
    case ErrorCode::kDiskFull: return "disk_full";
    case ErrorCode::kConflict:
    case ErrorCode::kForbidden:
    case ErrorCode::kInternal: break;
  }
  return "internal";
}

WorkerExit UnderstandEnd(int status, const WorkerProgress& last_words, bool is_killed_for_memory) {
  const std::string place = Place(last_words.stage);
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL && is_killed_for_memory)
    return {WorkerExit::Kind::kCrashed, "out_of_memory",
            "the worker ran out of memory" + place + " and was ended by the system"};
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXFSZ)
    return {WorkerExit::Kind::kFailed, "disk_full",
            "the worker wrote a larger file" + place + " than a job may, and was ended"};
  if (WIFSIGNALED(status))
    return {WorkerExit::Kind::kCrashed, "crashed",
            "the worker crashed" + place + ": " + ::strsignal(WTERMSIG(status))};
  const int exit_status = WEXITSTATUS(status);
  switch (static_cast<WorkerStatus>(exit_status)) {
    case WorkerStatus::kDone: return {WorkerExit::Kind::kDone, "", ""};
    case WorkerStatus::kDiskFull:
      return {WorkerExit::Kind::kFailed, "disk_full",
              last_words.error.value_or("the disk was full" + place)};
    case WorkerStatus::kOutOfMemory:
      return {WorkerExit::Kind::kFailed, "out_of_memory",
              last_words.error.value_or("the worker ran out of memory" + place)};
    default: break;
  }
  const bool is_inputs_fault = exit_status == static_cast<int>(WorkerStatus::kInvalidInput);
  const std::string code =
      CodeOfWorker(last_words.code.value_or(is_inputs_fault ? "invalid_input" : "internal"));
  const std::string silent =
      "the worker ended with status " + std::to_string(exit_status) + " and gave no reason";
  return {WorkerExit::Kind::kFailed, code, last_words.error.value_or(silent)};
}

WorkerExit ExplainTrouble(WorkerTrouble trouble, const JobLimits& limits,
                          const std::string& stage) {
  const std::string place = Place(stage);
  switch (trouble) {
    case WorkerTrouble::kHangs:
      return {WorkerExit::Kind::kFailed, "time_limit",
              "the worker hung" + place + ": it did nothing at all for " + Seconds(limits.hang) +
                  " and was ended"};
    case WorkerTrouble::kIsSilent:
      return {WorkerExit::Kind::kFailed, "time_limit",
              "the worker made no progress" + place + " for " + Seconds(limits.silence) +
                  " and was ended"};
    case WorkerTrouble::kOverMemory:
      return {WorkerExit::Kind::kFailed, "out_of_memory",
              "the worker took more memory" + place + " than the " +
                  std::to_string(limits.memory_bytes >> 20) +
                  " MiB that a job may use, and was ended"};
    case WorkerTrouble::kOverTasks:
      return {WorkerExit::Kind::kFailed, "internal",
              "the worker started" + place + " the " + std::to_string(limits.tasks) +
                  " processes and threads that a job may have, and was ended"};
    case WorkerTrouble::kIsLate:
    case WorkerTrouble::kNone: break;
  }
  return {WorkerExit::Kind::kFailed, "time_limit",
          "the job took longer than " + Seconds(limits.time) + " and was stopped" + place};
}

}  // namespace parkade
