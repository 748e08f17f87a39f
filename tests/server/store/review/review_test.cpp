#include "server/store/review/review.h"

#include <algorithm>
#include <atomic>
#include <thread>

#include "core/error.h"
#include "server/store/review/checklist.h"
#include "server/store/review/site_settings.h"
#include "tests/server/store/review/published_site.h"

namespace parkade {
namespace {

class Review : public PublishedSite {
 protected:
  ReviewEntry Do(const std::string& action, const std::string& comment = "",
                 std::optional<ReviewState> seen = std::nullopt) {
    return ReviewVersion(store_, "lot", 1, {action, comment, seen}, "ann");
  }
  ReviewState StateNow() { return Version(1).review_state; }
  /// Brings the version into a state by a way that leads there.
  void Reach(ReviewState state) {
    if (state == ReviewState::kDraft) return;
    Do("submit");
    if (state == ReviewState::kApproved) Do("approve");
    if (state == ReviewState::kRejected) Do("reject", "a pillar is missing");
  }
};

TEST_F(Review, BeginsAsADraft) {
  EXPECT_EQ(StateNow(), ReviewState::kDraft);
  EXPECT_TRUE(ReviewOf(store_, "lot", 1, {}).history.empty());
}

TEST_F(Review, KeepsWhatWasDoneByWhomAndWhy) {
  Do("submit");
  Do("comment", "looks good up to the ramp");
  Do("reject", "the ramp is too low");

  const ReviewStatus status = ReviewOf(store_, "lot", 1, {});
  EXPECT_EQ(status.map.review_state, ReviewState::kRejected);
  EXPECT_EQ(status.num_entries, 3);
  ASSERT_EQ(status.history.size(), 3u);
  EXPECT_EQ(status.history[0].action, "reject");
  EXPECT_EQ(status.history[0].comment, "the ramp is too low");
  EXPECT_EQ(status.history[0].author, "ann");
  EXPECT_EQ(status.history[0].from, ReviewState::kInReview);
  EXPECT_EQ(status.history[1].to, ReviewState::kInReview) << "a remark decides nothing";
  EXPECT_FALSE(status.history[2].created_at.empty());
  const Page second{.limit = 2, .before = status.history[1].sequence};
  EXPECT_EQ(ReviewOf(store_, "lot", 1, second).history.front().action, "submit");
}

TEST_F(Review, ADecisionKeepsTheChecklistAsItWasThen) {
  ChangeSite(store_, "lot", {.review_checklist = {{{{"ramp", "Ramps driven"}, {"bay", "Bays"}}}}});
  TickItem(store_, "lot", 1, "ramp", true, "bob");
  Do("submit");
  Do("approve");
  TickItem(store_, "lot", 1, "bay", true, "ann");
  ChangeSite(store_, "lot", {.review_checklist = {std::nullopt}});

  const std::vector<ReviewEntry> history = ReviewOf(store_, "lot", 1, {}).history;
  EXPECT_FALSE(history[1].checklist) << "a submission decides nothing";
  ASSERT_TRUE(history[0].checklist);
  ASSERT_EQ(history[0].checklist->size(), 2u);
  EXPECT_EQ((*history[0].checklist)[0].item.text, "Ramps driven");
  EXPECT_EQ((*history[0].checklist)[0].ticked_by, "bob");
  EXPECT_FALSE((*history[0].checklist)[1].ticked_by) << "it was open";
}

TEST_F(Review, AllowsWhatTheTableSaysAndNothingElse) {
  using State = ReviewState;
  struct Case {
    State from;
    std::string action;
    std::optional<State> to;
  };
  const std::vector<Case> cases = {{State::kDraft, "submit", State::kInReview},
                                   {State::kDraft, "approve", {}},
                                   {State::kDraft, "reject", {}},
                                   {State::kDraft, "reopen", {}},
                                   {State::kInReview, "submit", {}},
                                   {State::kInReview, "approve", State::kApproved},
                                   {State::kInReview, "reject", State::kRejected},
                                   {State::kInReview, "reopen", {}},
                                   {State::kApproved, "submit", {}},
                                   {State::kApproved, "approve", {}},
                                   {State::kApproved, "reject", State::kRejected},
                                   {State::kApproved, "reopen", State::kInReview},
                                   {State::kRejected, "submit", {}},
                                   {State::kRejected, "approve", {}},
                                   {State::kRejected, "reject", {}},
                                   {State::kRejected, "reopen", State::kInReview}};
  for (const Case& c : cases) {
    store_.database.Write([&](Connection& connection) {
      connection.Execute("UPDATE maps SET review_state = 'draft'");
    });
    Reach(c.from);
    ASSERT_EQ(StateNow(), c.from);
    if (c.to) {
      EXPECT_EQ(Do(c.action, "why").to, *c.to) << ToText(c.from) << " " << c.action;
    } else {
      EXPECT_EQ(ErrorOf([&] { Do(c.action, "why"); }).code(), ErrorCode::kConflict)
          << ToText(c.from) << " " << c.action;
    }
    EXPECT_EQ(StateNow(), c.to.value_or(c.from));
  }
}

TEST_F(Review, ARejectionHasAReason) {
  Do("submit");
  for (const char* reason : {"", "  \n"})
    EXPECT_EQ(ErrorOf([&] { Do("reject", reason); }).code(), ErrorCode::kInvalidInput);
  EXPECT_EQ(StateNow(), ReviewState::kInReview);
}

TEST_F(Review, ADecisionOnWhatHasChangedIsRefused) {
  Do("submit");
  Do("approve", "", ReviewState::kInReview);

  const Error error = ErrorOf([&] { Do("reject", "no", ReviewState::kInReview); });
  EXPECT_EQ(error.code(), ErrorCode::kConflict);
  EXPECT_STREQ(error.what(),
               "version 1 is approved meanwhile, and not in_review any more: look at it again");
  EXPECT_EQ(StateNow(), ReviewState::kApproved);
}

TEST_F(Review, OfTwoDecisionsAtOnceOneIsTaken) {
  for (int round = 0; round < 20; ++round) {
    if (round > 0) Do("reopen");
    if (round == 0) Do("submit");
    std::atomic<int> num_taken = 0;
    const auto decide = [&](const std::string& action) {
      try {
        Do(action, "why", ReviewState::kInReview);
        ++num_taken;
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::kConflict);
      }
    };
    std::thread other([&] { decide("approve"); });
    decide("reject");
    other.join();
    EXPECT_EQ(num_taken, 1);
  }
}

TEST_F(Review, TakesNoTextThatIsNone) {
  EXPECT_EQ(ErrorOf([&] { Do("comment", std::string(1 << 20, 'x')); }).code(),
            ErrorCode::kInvalidInput);
  for (const std::string& text : {std::string("a\0b", 3), std::string("a\x1b[31m"),
                                  std::string("a\x7f"), std::string("a\xc2\x9b")})
    EXPECT_EQ(ErrorOf([&] { Do("comment", text); }).code(), ErrorCode::kInvalidInput);
  EXPECT_EQ(Do("comment", "<script>alert(1)</script>\n\tß").comment,
            "<script>alert(1)</script>\n\tß");
  EXPECT_EQ(ErrorOf([&] { Do("bless"); }).code(), ErrorCode::kInvalidInput);
}

TEST_F(Review, NamesTheNewestApprovedVersion) {
  const auto approved = [&] {
    return store_.database.Read(
        [](Connection& connection) { return ApprovedMapVersion(connection, "lot"); });
  };
  EXPECT_EQ(ErrorOf(approved).code(), ErrorCode::kNotFound);
  PublishAgain();
  PublishAgain();
  for (const std::int64_t version : {1, 2}) {
    ReviewVersion(store_, "lot", version, {"submit", "", {}}, "ann");
    ReviewVersion(store_, "lot", version, {"approve", "", {}}, "ann");
  }
  EXPECT_EQ(approved(), 2);

  ReviewVersion(store_, "lot", 2, {"reject", "withdrawn", {}}, "ann");
  EXPECT_EQ(approved(), 1);
}

TEST_F(Review, IsOfAVersionThatExists) {
  EXPECT_EQ(ErrorOf([&] {
              ReviewVersion(store_, "lot", 7, {"submit", "", {}}, "ann");
            }).code(),
            ErrorCode::kNotFound);
  EXPECT_EQ(ErrorOf([&] { ReviewOf(store_, "none", 1, {}); }).code(), ErrorCode::kNotFound);
}

}  // namespace
}  // namespace parkade
