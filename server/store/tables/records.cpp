#include "server/store/tables/records.h"

#include <array>
#include <utility>

#include "core/error.h"

namespace parkade {
namespace {

template <typename State, size_t size>
using Words = std::array<std::pair<State, const char*>, size>;

constexpr Words<DriveState, 5> kDriveStates = {{{DriveState::kReceived, "received"},
                                                {DriveState::kQueued, "queued"},
                                                {DriveState::kProcessing, "processing"},
                                                {DriveState::kReady, "ready"},
                                                {DriveState::kFailed, "failed"}}};
constexpr Words<JobState, 5> kJobStates = {{{JobState::kQueued, "queued"},
                                            {JobState::kRunning, "running"},
                                            {JobState::kDone, "done"},
                                            {JobState::kFailed, "failed"},
                                            {JobState::kCancelled, "cancelled"}}};

constexpr Words<ReviewState, 4> kReviewStates = {{{ReviewState::kDraft, "draft"},
                                                  {ReviewState::kInReview, "in_review"},
                                                  {ReviewState::kApproved, "approved"},
                                                  {ReviewState::kRejected, "rejected"}}};

template <typename State, size_t size>
const char* TextOf(const Words<State, size>& words, State state) {
  for (const auto& [known, text] : words)
    if (known == state) return text;
  throw Error(ErrorCode::kInternal, "a state without a name");
}

template <typename State, size_t size>
State StateOf(const Words<State, size>& words, const std::string& text) {
  for (const auto& [state, known] : words)
    if (text == known) return state;
  throw Error(ErrorCode::kInternal, "the database holds the unknown state '" + text + "'");
}

}  // namespace

const char* ToText(DriveState state) { return TextOf(kDriveStates, state); }
const char* ToText(JobState state) { return TextOf(kJobStates, state); }
const char* ToText(ReviewState state) { return TextOf(kReviewStates, state); }

std::optional<std::string> JsonOf(const std::vector<ReviewState>& states) {
  if (states.empty()) return std::nullopt;
  std::string json;
  for (const ReviewState state : states)
    json += (json.empty() ? "[\"" : ",\"") + std::string(ToText(state)) + '"';
  return json + "]";
}

DriveState DriveStateFromText(const std::string& text) { return StateOf(kDriveStates, text); }
JobState JobStateFromText(const std::string& text) { return StateOf(kJobStates, text); }
ReviewState ReviewStateFromText(const std::string& text) { return StateOf(kReviewStates, text); }

}  // namespace parkade
