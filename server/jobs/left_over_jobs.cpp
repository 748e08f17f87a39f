#include "server/jobs/left_over_jobs.h"

#include <csignal>
#include <filesystem>

#include "core/error.h"
#include "core/log.h"
#include "server/jobs/worker_process.h"
#include "server/store/job_queue.h"
#include "server/store/tables/job_table.h"

namespace parkade {
namespace {

/// Kills the worker of a job that an earlier service left behind, if it lives on this machine.
void KillLeftOver(const Job& job) {
  if (!job.place || !job.place->pid || !job.place->pid_started) return;
  const auto pid = static_cast<pid_t>(*job.place->pid);
  if (ProcessStartTime(pid) == job.place->pid_started) ::kill(-pid, SIGKILL);
}

}  // namespace

LeftOverJobs::LeftOverJobs(Store& store, const JobEngine& engine)
    : store_(store), engine_(engine), left_over_(store.database.Read(RunningJobs)) {}

bool LeftOverJobs::Recover() {
  const std::lock_guard lock(mutex_);
  try {
    for (; !left_over_.empty(); left_over_.pop_back()) {
      const Job& job = left_over_.back();
      if (GoesOn(job)) {
        to_take_up_.push_back(job);
        continue;
      }
      KillLeftOver(job);
      RecoverJob(store_, job);
      Log(LogLevel::kWarning, "job recovered", {{"job", job.id}, {"attempt", job.attempt}});
    }
  } catch (const Error& error) {
    LogError(std::string("jobs not recovered error=") + error.what());
  }
  return left_over_.empty();
}

std::optional<Job> LeftOverJobs::TakeUp() {
  const std::lock_guard lock(mutex_);
  if (to_take_up_.empty()) return std::nullopt;
  const Job job = to_take_up_.back();
  to_take_up_.pop_back();
  return job;
}

int LeftOverJobs::size() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(to_take_up_.size());
}

/// The engine may have it still, and what belongs to it is there.
bool LeftOverJobs::GoesOn(const Job& job) const {
  return engine_.capabilities().outlives_service && job.place &&
         job.place->engine == engine_.name() &&
         std::filesystem::exists(store_.directory.AttemptFolder(job.id, job.attempt) / "input");
}

}  // namespace parkade
