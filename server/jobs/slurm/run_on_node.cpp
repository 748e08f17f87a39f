#include "server/jobs/slurm/run_on_node.h"

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <string>

#include "core/error.h"
#include "server/jobs/local_engine.h"
#include "server/jobs/slurm/node_files.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kStopPatience{2500};  // a cancelled job is gone within 5 s
constexpr int kStopped = 128 + SIGTERM;

std::atomic<bool> is_stopped = false;  // what a handler may use: lock-free

/// A number that Slurm gives its jobs; `missing` where it does not.
std::string NumberFromSlurm(const char* variable, const std::string& missing) {
  const char* found = std::getenv(variable);
  const std::string text = found == nullptr ? missing : found;
  const bool is_number = !text.empty() && text.size() <= 18 &&
                         text.find_first_not_of("0123456789") == std::string::npos;
  Require(
      is_number, ErrorCode::kUsage,
      "this is for jobs of Slurm's: there is no " + std::string(variable) + " that is a number");
  return text;
}

}  // namespace

int RunOnNode(const fs::path& attempt) {
  struct sigaction action {};
  action.sa_handler = [](int) { is_stopped = true; };
  ::sigaction(SIGTERM, &action, nullptr);
  const std::string id = NumberFromSlurm("SLURM_JOB_ID", "");
  const int restarts = std::stoi(NumberFromSlurm("SLURM_RESTART_COUNT", "0"));
  const NodeOrder order = ReadNodeOrder(attempt);
  const fs::path run = RunFolder(attempt, id, restarts);
  // Not where the attempt has ended meanwhile, and its folders are gone.
  for (const fs::path& folder : {run, run / "out", run / "tmp"}) fs::create_directory(folder);
  const LocalAttempt::Place place{.worker = {.folder = run,
                                             .log = attempt / AttemptFolder::kLogName,
                                             .temporary_files = run / "tmp",
                                             // The preview lies beside the runs.
                                             .writable = {attempt},
                                             .hidden = order.data,
                                             .visible = order.visible},
                                  .products = run / "out",
                                  .progress = run / "progress.ndjson"};
  LocalAttempt worker(order.command, place, order.limits, kStopPatience);
  while (!worker.Look().has_ended)
    if (is_stopped) worker.Cancel();
  if (is_stopped) return kStopped;
  const WorkerExit exit = worker.Exit();
  WriteNodeExit(run, exit);
  return exit.kind == WorkerExit::Kind::kDone ? 0 : 1;
}

}  // namespace parkade
