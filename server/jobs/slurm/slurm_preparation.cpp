#include "server/jobs/slurm/slurm_preparation.h"

#include <algorithm>

#include "core/error.h"
#include "core/log.h"
#include "server/jobs/slurm/node_files.h"

namespace parkade {
namespace {

constexpr int kMaxRestarts = 2;

/// The number of the array that an element shows.
std::string ArrayOf(const SlurmJob& element) {
  return element.array_id == "0" ? element.id : element.array_id;
}

bool HasEnded(const SlurmJob& job) { return PhaseOf(job) == SlurmPhase::kEnded; }

}  // namespace

SlurmPreparation::SlurmPreparation(const SlurmCommands& commands, SlurmQueue& queue,
                                   std::filesystem::path folder, const std::string& comment,
                                   int count)
    : commands_(commands),
      queue_(queue),
      folder_(std::move(folder)),
      comment_(comment + kPreparationMark),
      count_(count) {
  for (int i = 0; i < count_; ++i) progress_.emplace_back(PreparationProgress(folder_, i));
  if (count_ > 0) queue_.Follow(comment_, "");
}

SlurmPreparation::~SlurmPreparation() { queue_.Forget(comment_); }

std::string SlurmPreparation::Begin(const SlurmQueue::Look* look) {
  if (count_ == 0) return "";
  const std::vector<SlurmJob> elements =
      look == nullptr ? std::vector<SlurmJob>() : Elements(*look);
  const auto alive = std::find_if_not(elements.begin(), elements.end(), HasEnded);
  if (alive != elements.end()) return id_ = ArrayOf(*alive);
  const bool has_ended = !elements.empty() || (begun_ && look != nullptr && look->begun > *begun_);
  if (has_ended) return "";
  if (begun_) return id_;
  begun_ = SlurmQueue::Clock::now();
  try {
    id_ = commands_.Submit({NodeScript(folder_), folder_, comment_, count_});
    LogInfo("slurm array=" + id_ + " comment=" + comment_);
  } catch (const Error& error) {
    LogWarning("slurm array=" + comment_ + " refused=" + error.what());
  }
  return id_;
}

bool SlurmPreparation::Tend(const SlurmQueue::Look& look) {
  reason_.clear();
  bool runs = false;
  for (const SlurmJob& element : Elements(look)) {
    const SlurmPhase phase = PhaseOf(element);
    runs = runs || phase == SlurmPhase::kRunning;
    if (phase == SlurmPhase::kWaiting) reason_ = element.reason;
    const bool is_held = phase == SlurmPhase::kWaiting && element.has_failed_to_start;
    if (is_held || (phase != SlurmPhase::kEnded && element.restarts > kMaxRestarts))
      queue_.Cancel(element.id);
  }
  if (runs) reason_.clear();
  return runs;
}

void SlurmPreparation::Cancel(const SlurmQueue::Look* look) {
  if (count_ == 0) return;
  if (!id_.empty()) return queue_.Cancel(id_);
  if (look == nullptr) return;
  const std::vector<SlurmJob> elements = Elements(*look);
  if (!elements.empty()) queue_.Cancel(ArrayOf(elements.front()));
}

bool SlurmPreparation::ReadProgress() {
  bool has_changed = false;
  for (ProgressReader& reader : progress_) has_changed = reader.Poll() || has_changed;
  return has_changed;
}

double SlurmPreparation::progress() const {
  double sum = 0;
  for (const ProgressReader& reader : progress_) sum += reader.latest().progress;
  return count_ == 0 ? 1 : sum / count_;
}

std::vector<SlurmJob> SlurmPreparation::Elements(const SlurmQueue::Look& look) const {
  std::vector<SlurmJob> elements;
  for (const auto& [id, job] : look.jobs)
    if (job.comment == comment_) elements.push_back(job);
  return elements;
}

}  // namespace parkade
