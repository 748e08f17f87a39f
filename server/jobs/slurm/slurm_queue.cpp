#include "server/jobs/slurm/slurm_queue.h"

#include <algorithm>

#include "core/error.h"
#include "core/log.h"

namespace parkade {
namespace {

using std::chrono::milliseconds;

constexpr int kIdleFactor = 15;     // looks are rarer where nobody waits for a job
constexpr milliseconds kSoon{300};  // after something was asked for
constexpr milliseconds kStrayPatience{
    5000};  // a job that has just given its end may be there still

}  // namespace

SlurmQueue::SlurmQueue(const SlurmCommands& commands, milliseconds interval,
                       std::filesystem::path folder,
                       std::function<bool(const std::string& comment)> is_wanted)
    : commands_(commands),
      interval_(interval),
      folder_((folder / "").string()),
      is_wanted_(std::move(is_wanted)),
      due_(Clock::now()),
      thread_([this] { Run(); }) {}

SlurmQueue::~SlurmQueue() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void SlurmQueue::Follow(const std::string& comment, const std::string& id) {
  {
    const std::lock_guard lock(mutex_);
    followed_[comment] = id;
    due_ = std::min(due_, Clock::now() + std::min(interval_, kSoon));
  }
  changed_.notify_all();
}

void SlurmQueue::Forget(const std::string& comment) {
  const std::lock_guard lock(mutex_);
  followed_.erase(comment);
}

std::shared_ptr<const SlurmQueue::Look> SlurmQueue::Wait(const std::shared_ptr<const Look>& seen,
                                                         milliseconds patience) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, patience, [&] { return latest_ != seen || is_stopping_; });
  return latest_;
}

void SlurmQueue::Cancel(const std::string& id) {
  try {
    commands_.Cancel({id});
  } catch (const Error& error) {
    LogWarning("slurm job=" + id + " not cancelled reason=" + error.what());
  }
  {
    const std::lock_guard lock(mutex_);
    due_ = std::min(due_, Clock::now() + std::min(interval_, kSoon));
  }
  changed_.notify_all();
}

void SlurmQueue::Run() {
  for (;;) {
    {
      std::unique_lock lock(mutex_);
      while (!is_stopping_ && Clock::now() < due_) changed_.wait_until(lock, due_);
      if (is_stopping_) return;
    }
    LookNow();
    const std::lock_guard lock(mutex_);
    due_ = Clock::now() + interval_ * (followed_.empty() ? kIdleFactor : 1);
  }
}

void SlurmQueue::LookNow() {
  auto look = std::make_shared<Look>();
  look->begun = Clock::now();
  try {
    for (SlurmJob& job : commands_.Queue())
      if (job.folder.starts_with(folder_)) look->jobs.emplace(job.id, std::move(job));
  } catch (const Error& error) {
    const std::lock_guard lock(mutex_);
    if (latest_->trouble != error.what()) LogWarning(std::string("slurm trouble=") + error.what());
    *look = *latest_;
    look->trouble = error.what();
  }
  EndStrays(*look);
  {
    const std::lock_guard lock(mutex_);
    latest_ = look;
  }
  changed_.notify_all();
}

void SlurmQueue::EndStrays(const Look& look) {
  std::map<std::string, Clock::time_point> strays;
  std::vector<std::string> to_end;
  for (const auto& [id, job] : look.jobs) {
    if (PhaseOf(job) == SlurmPhase::kEnded || !IsStray(job)) continue;
    const auto known = stray_since_.find(id);
    const Clock::time_point since = known == stray_since_.end() ? Clock::now() : known->second;
    strays.emplace(id, since);
    if (Clock::now() - since >= kStrayPatience) to_end.push_back(id);
  }
  stray_since_ = std::move(strays);
  if (to_end.empty()) return;
  LogWarning("slurm strays=" + std::to_string(to_end.size()) + " first=" + to_end.front());
  try {
    commands_.Cancel(to_end);
  } catch (const Error& error) {
    LogWarning(std::string("slurm strays not ended reason=") + error.what());
  }
}

/// Nobody waits for it, and nobody will.
bool SlurmQueue::IsStray(const SlurmJob& job) {
  {
    const std::lock_guard lock(mutex_);
    const auto found = followed_.find(job.comment);
    if (found != followed_.end()) return !found->second.empty() && found->second != job.id;
  }
  return !is_wanted_(job.comment);
}

}  // namespace parkade
