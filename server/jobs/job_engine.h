#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "server/jobs/attempt_folder.h"
#include "server/jobs/progress_reader.h"
#include "server/jobs/worker_exit.h"
#include "server/store/tables/records.h"

namespace parkade {

/// What a look at an attempt found.
struct AttemptNews {
  bool has_ended = false;
  bool has_spoken = false;  ///< there is new progress
};

/// An attempt at a job that an engine has. For the thread that got it.
class EngineAttempt {
 public:
  /// Where the engine's attempts do not outlive the service, ends it.
  virtual ~EngineAttempt() = default;

  /// Waits a moment, a second at most, and looks. Commands of the engine that are slow may take
  /// longer.
  virtual AttemptNews Look() = 0;

  /// Where it is now. It is to be stored before the next look.
  virtual JobPlace place() const = 0;
  /// Why it waits, in the engine's words; empty where it does not.
  virtual std::string reason() const { return ""; }
  virtual const WorkerProgress& progress() const = 0;

  /// Asks for its end, which comes within seconds. May be called again.
  virtual void Cancel() = 0;

  /// How it ended, and the folder with what it made. Once a look said that it has ended.
  virtual WorkerExit Exit() const = 0;
  virtual std::filesystem::path products() const = 0;
};

struct EngineCapabilities {
  /// Attempts go on when the service ends, and the next one takes them up.
  bool outlives_service = false;
  /// Several new drives of a site are tracked beside each other: one map takes them in sooner than
  /// one after the other.
  bool prepares_drives = false;
};

/// Runs the workers of jobs. The truth about jobs is in the store; an engine is only asked.
/// Thread-safe.
class JobEngine {
 public:
  virtual ~JobEngine() = default;

  /// As JobPlace::engine has it.
  virtual std::string name() const = 0;
  virtual EngineCapabilities capabilities() const = 0;

  /// Starts a worker for the running attempt of `job`, or takes up the one that an earlier service
  /// started with this engine: `job.place` says that. `folder` outlives what is returned. Throws
  /// Error{kInternal} where that is not possible.
  virtual std::unique_ptr<EngineAttempt> Run(const Job& job, const AttemptFolder& folder) = 0;
};

}  // namespace parkade
