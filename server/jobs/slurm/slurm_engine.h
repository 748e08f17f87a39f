#pragma once

#include <memory>
#include <string>

#include "server/jobs/job_engine.h"
#include "server/jobs/job_limits.h"
#include "server/jobs/job_spec.h"
#include "server/jobs/slurm/node_files.h"
#include "server/jobs/slurm/slurm_commands.h"
#include "server/jobs/slurm/slurm_options.h"
#include "server/jobs/slurm/slurm_queue.h"
#include "server/store/store.h"

namespace parkade {

/// Runs workers as jobs of Slurm's, on nodes that see the data directory by the same name. They go
/// on when the service ends. Several drives that nothing is known of are prepared by an array of
/// jobs first. A node runs a worker as the local engine would (RunOnNode).
class SlurmEngine : public JobEngine {
 public:
  /// Throws Error{kUsage} for options that make no sense. `limits`: what a worker's watch goes by;
  /// its time and memory are taken from `options`.
  SlurmEngine(Store& store, JobCommand command, const JobLimits& limits,
              const SlurmOptions& options);

  std::string name() const override { return kName; }
  EngineCapabilities capabilities() const override {
    return {.outlives_service = true, .prepares_drives = true};
  }
  std::unique_ptr<EngineAttempt> Run(const Job& job, const AttemptFolder& folder) override;

  static constexpr const char* kName = "slurm";

 private:
  NodeOrder OrderFor(const AttemptFolder& folder) const;

  const JobCommand command_;
  const SlurmOptions options_;
  JobLimits limits_;
  SlurmCommands commands_;
  SlurmQueue queue_;
};

}  // namespace parkade
