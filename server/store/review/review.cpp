#include "server/store/review/review.h"

#include <algorithm>
#include <array>

#include "core/error.h"
#include "core/log.h"
#include "server/store/access/audit_log.h"
#include "server/store/review/checklist.h"
#include "server/store/tables/names.h"
#include "server/store/tables/outbox.h"
#include "server/store/tables/text_rules.h"

namespace parkade {
namespace {

using State = ReviewState;

struct Transition {
  const char* action;
  State from, to;
};
constexpr std::array kTransitions = {Transition{"submit", State::kDraft, State::kInReview},
                                     Transition{"approve", State::kInReview, State::kApproved},
                                     Transition{"reject", State::kInReview, State::kRejected},
                                     Transition{"reject", State::kApproved, State::kRejected},
                                     Transition{"reopen", State::kApproved, State::kInReview},
                                     Transition{"reopen", State::kRejected, State::kInReview}};

constexpr size_t kMaxReason = 4000;           // [bytes]
constexpr std::int64_t kMaxEntries = 10'000;  // of one version

const std::string kComment = "comment", kApprove = "approve", kReject = "reject";

void CheckStep(const ReviewStep& step) {
  const bool is_known = step.action == kComment ||
                        std::any_of(kTransitions.begin(), kTransitions.end(),
                                    [&](const Transition& t) { return step.action == t.action; });
  Require(is_known, ErrorCode::kInvalidInput,
          "\"action\" is one of submit, approve, reject, reopen and comment");
  const bool needs_reason = step.action == kReject || step.action == kComment;
  Require(!needs_reason || !step.comment.empty(), ErrorCode::kInvalidInput,
          step.action == kReject ? "a rejection needs its reason in \"comment\""
                                 : "a remark needs its text in \"comment\"");
  CheckText(step.comment, {.name = "comment",
                           .max_bytes = kMaxReason,
                           .is_required = needs_reason,
                           .may_have_lines = true});
}

std::string NameOf(const MapVersion& map) { return "version " + std::to_string(map.version); }

State NextState(const MapVersion& map, const ReviewStep& step) {
  const State state = map.review_state;
  Require(!step.seen || *step.seen == state, ErrorCode::kConflict,
          NameOf(map) + " is " + ToText(state) + " meanwhile, and not " +
              ToText(step.seen.value_or(state)) + " any more: look at it again");
  if (step.action == kComment) return state;
  for (const Transition& transition : kTransitions)
    if (step.action == transition.action && state == transition.from) return transition.to;
  throw Error(ErrorCode::kConflict,
              NameOf(map) + " is " + ToText(state) + ": \"" + step.action + "\" does not fit");
}

}  // namespace

ReviewState ParseReviewState(const std::string& text) {
  for (const State state : {State::kDraft, State::kInReview, State::kApproved, State::kRejected})
    if (text == ToText(state)) return state;
  throw Error(ErrorCode::kInvalidInput,
              "a state is one of draft, in_review, approved and rejected");
}

ReviewEntry ReviewVersion(Store& store, const std::string& site, std::int64_t version,
                          const ReviewStep& step, const std::string& author) {
  CheckStep(step);
  ReviewEntry entry = store.database.Write([&](Connection& connection) {
    const MapVersion map = FindMapRow(connection, site, version);
    const State next = NextState(map, step);
    if (step.action != kComment) RequireFiles(map);
    Require(CountReviewEntries(connection, map.id) < kMaxEntries, ErrorCode::kConflict,
            NameOf(map) + " has a history of " + std::to_string(kMaxEntries) +
                " entries, and takes no more");
    ReviewEntry made{0,      step.action, map.review_state, next, step.comment,
                     author, NowUtc(),    std::nullopt};
    // What was open then is told to whoever asks later why a map was let through.
    if (step.action == kApprove || step.action == kReject)
      made.checklist = EntriesOf(connection, map);
    AddReviewEntry(connection, map.id, made);
    RecordAudit(connection, "map.review", site + "/" + std::to_string(version),
                "{\"action\":\"" + step.action + "\",\"to\":\"" + ToText(next) + "\"}");
    if (next != map.review_state) NoteReviewed(connection, map, made);
    return ListReviewEntries(connection, map.id, {.limit = 1}).front();
  });
  LogInfo("reviewed site=" + site + " version=" + std::to_string(version) +
          " action=" + step.action + " state=" + ToText(entry.to) + " by=" + author);
  return entry;
}

ReviewStatus ReviewOf(Store& store, const std::string& site, std::int64_t version,
                      const Page& page) {
  return store.database.Read([&](Connection& connection) {
    ReviewStatus status;
    status.map = FindMapRow(connection, site, version);
    status.history = ListReviewEntries(connection, status.map.id, page);
    status.num_entries = CountReviewEntries(connection, status.map.id);
    status.comments = CountComments(connection, status.map.id);
    return status;
  });
}

}  // namespace parkade
