#include "server/jobs/slurm/slurm_engine.h"

#include <algorithm>

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
bool IsRunning(Store& store, const std::string& comment) {
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

std::unique_ptr<EngineAttempt> SlurmEngine::Run(const Job& job, const AttemptFolder& folder) {
  if (!job.place) {
    JobSpec spec = folder.spec();
    spec.out = "./out";
    spec.progress = "./progress.ndjson";
    spec.num_threads = options_.cpus;
    WriteNodeOrder(folder.path(), {command_(spec), limits_, folder.data(), InputsOf(spec)});
    WriteNodeScript(folder.path());
  }
  return std::make_unique<SlurmAttempt>(commands_, queue_, options_.exit_patience, folder.path(),
                                        CommentOf(job), job.place);
}

}  // namespace parkade
