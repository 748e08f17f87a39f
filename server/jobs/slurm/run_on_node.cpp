#include "server/jobs/slurm/run_on_node.h"

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "server/jobs/local_engine.h"
#include "server/jobs/slurm/node_files.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kStopPatience{2500};  // a cancelled job is gone within 5 s
constexpr const char* kTask = "SLURM_ARRAY_TASK_ID";
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

/// Runs a worker to its end; nothing where Slurm stopped it.
std::optional<WorkerExit> RunWorker(const std::vector<std::string>& command,
                                    const LocalAttempt::Place& place, const JobLimits& limits) {
  // Not where the attempt has ended meanwhile and its folders are gone, nor in what another worker
  // has put there.
  const fs::path& run = place.worker.folder;
  for (const fs::path& folder : {run, run / "out", run / "tmp"})
    Require(fs::create_directory(folder), ErrorCode::kInternal,
            "the run's folder is there already");
  LocalAttempt worker(command, place, limits, kStopPatience);
  while (!worker.Look().has_ended)
    if (is_stopped) worker.Cancel();
  return is_stopped ? std::nullopt : std::optional(worker.Exit());
}

LocalAttempt::Place PlaceIn(const fs::path& run, const fs::path& log, const fs::path& progress,
                            const fs::path& attempt, const NodeOrder& order) {
  return {.worker = {.folder = run,
                     .log = log,
                     .temporary_files = run / "tmp",
                     .writable = {WorkerFolder(attempt)},
                     .hidden = order.data,
                     .visible = order.visible},
          .products = run / "out",
          .progress = progress};
}

/// Whether and how it ended is told by what it leaves: the run after it does what is missing.
int Prepare(const fs::path& attempt, const NodeOrder& order, int number, const std::string& id,
            int restarts) {
  Require(number >= 0 && static_cast<std::size_t>(number) < order.preparations.size(),
          ErrorCode::kUsage, "the order has no preparation " + std::to_string(number));
  const LocalAttempt::Place place =
      PlaceIn(PreparationFolder(attempt, number, id, restarts), PreparationLog(attempt, number),
              PreparationProgress(attempt, number), attempt, order);
  const auto exit =
      RunWorker(order.preparations[static_cast<std::size_t>(number)], place, order.limits);
  if (!exit) return kStopped;
  return exit->kind == WorkerExit::Kind::kDone ? 0 : 1;
}

/// What the preparations printed comes before what the run prints. They have ended.
void TakeOverLogs(const fs::path& attempt, const NodeOrder& order) {
  std::ofstream log(attempt / AttemptFolder::kLogName, std::ios::app);
  for (int i = 0; i < static_cast<int>(order.preparations.size()); ++i) {
    std::ifstream own(PreparationLog(attempt, i));
    if (own.peek() != std::ifstream::traits_type::eof())
      log << "preparation " << i + 1 << " of " << order.preparations.size() << ":\n" << own.rdbuf();
  }
}

}  // namespace

int RunOnNode(const fs::path& attempt) {
  struct sigaction action {};
  action.sa_handler = [](int) { is_stopped = true; };
  ::sigaction(SIGTERM, &action, nullptr);
  const std::string id = NumberFromSlurm("SLURM_JOB_ID", "");
  const int restarts = std::stoi(NumberFromSlurm("SLURM_RESTART_COUNT", "0"));
  const NodeOrder order = ReadNodeOrder(attempt);
  if (std::getenv(kTask) != nullptr)
    return Prepare(attempt, order, std::stoi(NumberFromSlurm(kTask, "")), id, restarts);
  if (restarts == 0) TakeOverLogs(attempt, order);
  const fs::path run = RunFolder(attempt, id, restarts);
  const auto exit = RunWorker(
      order.command,
      PlaceIn(run, attempt / AttemptFolder::kLogName, run / "progress.ndjson", attempt, order),
      order.limits);
  if (!exit) return kStopped;
  WriteNodeExit(attempt, run, *exit);
  return exit->kind == WorkerExit::Kind::kDone ? 0 : 1;
}

}  // namespace parkade
