#include "tests/bench/speed/run_program.h"

#include <linux/perf_event.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>

#include "core/error.h"

namespace parkade {
namespace {

/// A counter of the instructions of children that are made from now on; -1 where there is none.
int CountInstructionsOfChildren() {
  perf_event_attr attributes{};
  attributes.type = PERF_TYPE_HARDWARE;
  attributes.size = sizeof attributes;
  attributes.config = PERF_COUNT_HW_INSTRUCTIONS;
  attributes.inherit = 1;
  attributes.exclude_kernel = 1;
  return static_cast<int>(::syscall(SYS_perf_event_open, &attributes, 0, -1, -1, 0));
}

double SecondsOf(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

ProgramCost RunProgram(const std::vector<std::string>& command) {
  std::vector<char*> arguments;
  for (const std::string& argument : command)
    arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  const int counter = CountInstructionsOfChildren();
  const auto start = std::chrono::steady_clock::now();
  const pid_t child = ::fork();
  Require(child >= 0, ErrorCode::kInternal, "no process can be started");
  if (child == 0) {
    ::execvp(arguments[0], arguments.data());
    ::_exit(127);
  }
  int status = 0;
  rusage usage{};
  ::wait4(child, &status, 0, &usage);
  ProgramCost cost;
  cost.exit_status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  cost.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  cost.processor_seconds = SecondsOf(usage.ru_utime) + SecondsOf(usage.ru_stime);
  cost.peak_memory_bytes = std::int64_t{1024} * usage.ru_maxrss;
  std::int64_t count = 0;
  if (counter >= 0 && ::read(counter, &count, sizeof count) == sizeof count && count > 0)
    cost.instructions = count;
  if (counter >= 0) ::close(counter);
  return cost;
}

}  // namespace parkade
