#include "server/jobs/slurm/slurm_engine.h"

#include <algorithm>
#include <vector>

#include "core/error.h"
#include "server/jobs/slurm/node_files.h"
#include "server/jobs/slurm/slurm_attempt.h"
#include "server/store/tables/job_table.h"

namespace parkade {
namespace {

const std::string kPrefix = "parkade-";

/// By which Slurm's queue tells an attempt.
std::string CommentOf(const Job& job) {
  return kPrefix + job.id + "-" + std::to_string(job.attempt);
}

/// Whether the attempt with this comment may still run.
bool IsRunning(Store& store, std::string comment) {
  if (comment.ends_with(kPreparationMark)) comment.resize(comment.size() - kPreparationMark.size());
  const std::size_t dash = comment.rfind('-');
  if (!comment.starts_with(kPrefix) || dash < kPrefix.size()) return false;
  try {
    const Job job = store.database.Read([&](Connection& connection) {
      return FindJob(connection, comment.substr(kPrefix.size(), dash - kPrefix.size()));
    });
    return job.state == JobState::kRunning && CommentOf(job) == comment;
  } catch (const Error& error) {
    return error.code() != ErrorCode::kNotFound;
  }
}

/// Numbers, from 1, of the drives whose odometry is neither in the map to start from nor found by
/// an earlier attempt.
std::vector<int> DrivesToPrepare(const JobSpec& spec) {
  std::vector<int> drives;
  for (std::size_t i = 0; i < spec.logs.size(); ++i) {
    const std::filesystem::path odometry = spec.logs[i].filename() / "odometry.bin";
    const bool is_known = (spec.from && std::filesystem::exists(*spec.from / odometry)) ||
                          std::filesystem::exists(spec.work / odometry);
    if (!is_known) drives.push_back(static_cast<int>(i) + 1);
  }
  return drives;
}

/// How many the order has; none where it is gone, after which only the end is awaited.
int CountPreparations(const std::filesystem::path& attempt) {
  try {
    return static_cast<int>(ReadNodeOrder(attempt).preparations.size());
  } catch (const Error&) {
    return 0;
  }
}

const SlurmOptions& Checked(const SlurmOptions& options) {
  CheckSlurmOptions(options);
  return options;
}

/// A little below what Slurm allows, so that the worker's own watch says what happened.
JobLimits LimitsBelow(const SlurmOptions& options, JobLimits limits) {
  const std::chrono::seconds time = options.time;
  limits.time = time - std::min(std::chrono::seconds(60), time / 4);
  const std::int64_t memory = options.memory_mib << 20;
  limits.memory_bytes = memory - memory / 16;
  return limits;
}

}  // namespace

SlurmEngine::SlurmEngine(Store& store, JobCommand command, const JobLimits& limits,
                         const SlurmOptions& options)
    : command_(std::move(command)),
      options_(Checked(options)),
      limits_(LimitsBelow(options, limits)),
      commands_(options_),
      queue_(commands_, options_.poll_interval, store.directory.JobsFolder(),
             [&store](const std::string& comment) { return IsRunning(store, comment); }) {}

/// What a node is to do for the attempt.
NodeOrder SlurmEngine::OrderFor(const AttemptFolder& folder) const {
  JobSpec spec = folder.spec();
  spec.out = "./out";
  spec.progress = "./progress.ndjson";
  spec.num_threads = options_.cpus;
  NodeOrder order{command_(spec), limits_, folder.data(), InputsOf(spec)};
  const std::vector<int> drives = DrivesToPrepare(spec);
  if (drives.size() < 2) return order;  // one is prepared as fast by the run itself
  for (const int drive : drives) {
    spec.prepared = drive;
    spec.progress = PreparationProgress(folder.path(), static_cast<int>(order.preparations.size()));
    order.preparations.push_back(command_(spec));
  }
  return order;
}

std::unique_ptr<EngineAttempt> SlurmEngine::Run(const Job& job, const AttemptFolder& folder) {
  if (!job.place) {
    WriteNodeOrder(folder.path(), OrderFor(folder));
    WriteNodeScript(folder.path());
  }
  return std::make_unique<SlurmAttempt>(commands_, queue_, options_.exit_patience, folder.path(),
                                        CommentOf(job), CountPreparations(folder.path()),
                                        job.place);
}

}  // namespace parkade
