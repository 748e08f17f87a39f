#include "server/jobs/slurm/slurm_attempt.h"

#include <algorithm>
#include <utility>

#include "core/error.h"
#include "core/log.h"
#include "server/jobs/slurm/node_files.h"

namespace parkade {
namespace {

using std::chrono::milliseconds;
using Kind = WorkerExit::Kind;

constexpr milliseconds kInterval{1000};        // between looks
constexpr milliseconds kHasty{100};            // the same, while its end is awaited
constexpr milliseconds kMaxPause{60'000};      // between tries to hand it over
constexpr milliseconds kCancelPatience{3500};  // then it counts as ended, also without Slurm's word
constexpr int kMaxRestarts = 5;
constexpr double kPreparedShare = 0.6;
const std::string kPreparationStage = "prepare drives";

}  // namespace

SlurmAttempt::SlurmAttempt(const SlurmCommands& commands, SlurmQueue& queue,
                           milliseconds exit_patience, std::filesystem::path folder,
                           std::string comment, int num_preparations,
                           const std::optional<JobPlace>& place)
    : commands_(commands),
      queue_(queue),
      exit_patience_(exit_patience),
      folder_(std::move(folder)),
      comment_(std::move(comment)),
      preparation_(commands, queue, folder_, comment_, num_preparations),
      prepared_share_(num_preparations > 0 ? kPreparedShare : 0),
      place_(place.value_or(JobPlace{.engine = "slurm", .waits = true})),
      known_since_(Clock::now()) {
  if (!place_.id && place) unsure_since_ = Clock::now();
  queue_.Follow(comment_, place_.id.value_or(""));
}

SlurmAttempt::~SlurmAttempt() { queue_.Forget(comment_); }

AttemptNews SlurmAttempt::Look() {
  if (!place_.id && !unsure_since_ && !cancelled_ && Clock::now() >= next_try_) {
    Submit();
  } else {
    look_ = queue_.Wait(look_, cancelled_ ? kHasty : kInterval);
  }
  if (!place_.id) HandOver();
  const bool has_spoken = ReadProgress();
  end_ = FindEnd();
  return {.has_ended = end_.has_value(), .has_spoken = has_spoken};
}

void SlurmAttempt::Cancel() {
  if (!cancelled_) cancelled_ = Clock::now();
  // First what waits for the preparation, lest it starts.
  if (place_.id) queue_.Cancel(*place_.id);
  preparation_.Cancel(look_.get());
}

/// Finds out whether Slurm has taken what it did not answer for.
void SlurmAttempt::HandOver() {
  if (!unsure_since_ || !look_) return;
  if (!look_->trouble.empty()) reason_ = look_->trouble;
  if (look_->begun <= *unsure_since_) return;
  for (const auto& [id, job] : look_->jobs)
    if (job.comment == comment_) return SetId(id);
  unsure_since_.reset();  // it has not
}

void SlurmAttempt::Submit() {
  try {
    const std::string after = preparation_.Begin(look_.get());
    SetId(commands_.Submit(
        {.script = NodeScript(folder_), .folder = folder_, .comment = comment_, .after = after}));
  } catch (const Error& error) {
    refusals_ = refusal_ == error.what() ? refusals_ + 1 : 1;
    refusal_ = error.what();
    is_refused_ = refusals_ >= MaxTries(refusal_).value_or(refusals_ + 1);
    if (reason_ != error.what()) LogWarning("slurm job=" + comment_ + " refused=" + error.what());
    reason_ = error.what();
    unsure_since_ = Clock::now();
    next_try_ = Clock::now() + pause_;
    pause_ = std::min(2 * pause_, kMaxPause);
  }
}

void SlurmAttempt::SetId(const std::string& id) {
  place_.id = id;
  reason_.clear();
  unsure_since_.reset();
  known_since_ = Clock::now();
  queue_.Follow(comment_, id);
  LogInfo("slurm job=" + id + " comment=" + comment_);
}

std::optional<SlurmAttempt::End> SlurmAttempt::FindEnd() {
  if (const auto found = FindNodeExit(folder_)) return End{found->exit, found->run / "out"};
  const auto asked = AskSlurm();
  if (asked) return End{*asked, {}};
  if (is_refused_ && !unsure_since_)
    return End{{Kind::kFailed, "internal", "Slurm does not take the job: " + refusal_}, {}};
  const bool is_given_up =
      cancelled_ && (!place_.id || Clock::now() - *cancelled_ >= kCancelPatience);
  if (is_given_up) return End{{Kind::kCancelled, "cancelled", "cancelled"}, {}};
  return std::nullopt;
}

std::optional<WorkerExit> SlurmAttempt::AskSlurm() {
  if (!place_.id || !look_) return std::nullopt;
  if (!look_->trouble.empty()) reason_ = look_->trouble;
  if (!look_->trouble.empty() || look_->begun <= known_since_) return std::nullopt;
  const auto found = look_->jobs.find(*place_.id);
  // A controller that lost its latest state gives the same number again, to another job.
  const bool is_ours = found != look_->jobs.end() && found->second.comment == comment_;
  if (is_ours) return Understand(found->second);
  return AfterPatience(
      {Kind::kCrashed, "crashed", "Slurm does not know the job any more, and it left no word"});
}

std::optional<WorkerExit> SlurmAttempt::Understand(const SlurmJob& job) {
  const SlurmPhase phase = PhaseOf(job);
  const bool is_preparing = preparation_.Tend(*look_);
  place_.waits = phase == SlurmPhase::kWaiting && !is_preparing;
  reason_ = !place_.waits ? "" : preparation_.reason().empty() ? job.reason : preparation_.reason();
  if (job.restarts != restarts_)
    LogWarning("slurm job=" + job.id + " starts again restarts=" + std::to_string(job.restarts));
  restarts_ = job.restarts;
  if (phase != SlurmPhase::kEnded) {
    silent_since_.reset();
    return GiveUp(job);
  }
  const WorkerExit exit = ExplainSlurmEnd(job, latest_.stage);
  // It ended by itself: its last word is on the way.
  if (job.state == "COMPLETED" || job.state == "FAILED") return AfterPatience(exit);
  return exit;
}

/// Ends a job that Slurm would keep for ever.
std::optional<WorkerExit> SlurmAttempt::GiveUp(const SlurmJob& job) {
  const bool is_held = place_.waits && job.has_failed_to_start;
  if (!is_held && restarts_ < kMaxRestarts) return std::nullopt;
  queue_.Cancel(job.id);
  if (is_held)
    return WorkerExit{Kind::kCrashed, "crashed", "Slurm could not start the job on its node"};
  return WorkerExit{
      Kind::kFailed, "crashed",
      "Slurm had to start the job again " + std::to_string(restarts_) + " times: it was ended"};
}

std::optional<WorkerExit> SlurmAttempt::AfterPatience(const WorkerExit& exit) {
  if (!silent_since_) silent_since_ = Clock::now();
  if (Clock::now() - *silent_since_ < exit_patience_ && !cancelled_) return std::nullopt;
  return exit;
}

/// Follows the latest run, and before it the preparation.
bool SlurmAttempt::ReadProgress() {
  if (ReadRun()) {
    latest_ = run_->latest();
    latest_.progress = prepared_share_ + (1 - prepared_share_) * latest_.progress;
    return true;
  }
  const bool has_run = run_ && !run_->latest().stage.empty();
  if (has_run || !preparation_.ReadProgress()) return false;
  latest_.stage = kPreparationStage;
  latest_.progress = prepared_share_ * preparation_.progress();
  return true;
}

bool SlurmAttempt::ReadRun() {
  if (!place_.id) return false;
  const std::filesystem::path file = RunFolder(folder_, *place_.id, restarts_) / "progress.ndjson";
  if (!run_ || run_->file() != file) run_.emplace(file);
  return run_->Poll();
}

}  // namespace parkade
