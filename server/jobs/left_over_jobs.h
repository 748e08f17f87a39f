#pragma once

#include <mutex>
#include <optional>
#include <vector>

#include "server/jobs/job_engine.h"
#include "server/store/store.h"
#include "server/store/tables/records.h"

namespace parkade {

/// The jobs that an earlier service left running. Those that the engine goes on with are to be
/// taken up; the others go back into the queue, their workers killed. Thread-safe.
class LeftOverJobs {
 public:
  LeftOverJobs(Store& store, const JobEngine& engine);

  /// False while a full disk does not take it: nothing may start before. To be tried again.
  bool Recover();

  /// A job to take up, which is then the caller's. Once Recover has said that all is well.
  std::optional<Job> TakeUp();

  /// How many are to be taken up.
  int size() const;

 private:
  bool GoesOn(const Job& job) const;

  Store& store_;
  const JobEngine& engine_;
  mutable std::mutex mutex_;
  std::vector<Job> left_over_;
  std::vector<Job> to_take_up_;
};

}  // namespace parkade
