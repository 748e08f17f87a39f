#include "server/store/review/comments.h"

#include <limits>

#include "core/error.h"
#include "tests/server/store/review/published_site.h"

namespace parkade {
namespace {

class Comments : public PublishedSite {
 protected:
  Comment Add(const std::string& text, const CommentPin& pin = {},
              const std::string& author = "ann") {
    return AddComment(store_, "lot", 1, {text, std::nullopt, pin}, author);
  }
  Comment Answer(const Comment& first, const std::string& text, const std::string& author = "bob") {
    return AddComment(store_, "lot", 1, {text, first.id, {}}, author);
  }
  Comment Change(const Comment& comment, const CommentChange& change,
                 const std::string& author = "ann") {
    return ChangeComment(store_, "lot", 1, comment.id, change, author);
  }
  static Caller As(const std::string& name, Role role = Role::kReviewer) {
    Caller caller = CallerWithAllRights(name);
    caller.role = role;
    return caller;
  }
  void Delete(const Comment& comment, const Caller& caller = As("ann")) {
    DeleteComment(store_, "lot", 1, comment.id, caller);
  }
  std::vector<Comment> All(const std::optional<std::string>& thread = std::nullopt,
                           const Page& page = {}) {
    return store_.database.Read(
        [&](Connection& connection) { return ListComments(connection, map_.id, thread, page); });
  }
  ErrorCode CodeOf(const CommentPin& pin) {
    return ErrorOf([&] { Add("here", pin); }).code();
  }
};

TEST_F(Comments, ArePinnedToAPointADriveAndTimeASlotALoopOrNothing) {
  const std::string drive = received_.drive.id;
  const std::vector<CommentPin> pins = {{},
                                        {.point = {{1.5, -2.25, 0.1}}},
                                        {.drive = drive},
                                        {.drive = drive, .time = 1700000000.123456},
                                        {.slot = "A-17"},
                                        {.loop = "a:17-140"}};
  for (const CommentPin& pin : pins) EXPECT_EQ(Add("here", pin).pin, pin);

  EXPECT_EQ(All().size(), pins.size());
  EXPECT_EQ(All().front().pin, pins.back()) << "newest first";
}

TEST_F(Comments, ArePinnedToNothingElse) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const std::string drive = received_.drive.id;
  EXPECT_EQ(CodeOf({.point = {{0, nan, 0}}}), ErrorCode::kInvalidInput);
  EXPECT_EQ(CodeOf({.point = {{0, 0, infinity}}}), ErrorCode::kInvalidInput);
  EXPECT_EQ(CodeOf({.point = {{1e9, 0, 0}}}), ErrorCode::kInvalidInput);
  EXPECT_EQ(CodeOf({.drive = drive, .time = nan}), ErrorCode::kInvalidInput);
  EXPECT_EQ(CodeOf({.time = 7.0}), ErrorCode::kInvalidInput);
  EXPECT_EQ(CodeOf({.drive = std::string("0000000000000000")}), ErrorCode::kInvalidInput);
  EXPECT_EQ(CodeOf({.slot = std::string("")}), ErrorCode::kInvalidInput);
  EXPECT_EQ(CodeOf({.slot = std::string(201, 's')}), ErrorCode::kInvalidInput);
  EXPECT_EQ(CodeOf({.point = {{0, 0, 0}}, .slot = "A-17"}), ErrorCode::kInvalidInput);
  EXPECT_TRUE(All().empty());
}

TEST_F(Comments, ADriveOfAnotherSiteIsNotInTheVersion) {
  const ReceivedDrive other = Receive(store_, "other", {"b.bag", "street", std::nullopt});
  EXPECT_EQ(CodeOf({.drive = other.drive.id}), ErrorCode::kInvalidInput);
}

TEST_F(Comments, AreAnsweredInTheirThread) {
  const Comment first = Add("what is this?"), other = Add("and that?");
  const Comment answer = Answer(first, "a puddle");
  Answer(other, "a shadow");

  EXPECT_EQ(answer.thread, first.id);
  const std::vector<Comment> thread = All(first.id);
  ASSERT_EQ(thread.size(), 2u);
  EXPECT_EQ(thread[0].id, answer.id);
  EXPECT_EQ(ErrorOf([&] { Answer(answer, "no"); }).code(), ErrorCode::kInvalidInput)
      << "threads have no threads";
  const NewComment pinned{"no", first.id, {.slot = "A-17"}};
  EXPECT_EQ(ErrorOf([&] { AddComment(store_, "lot", 1, pinned, "bob"); }).code(),
            ErrorCode::kInvalidInput);
}

TEST_F(Comments, BelongToTheirVersion) {
  const Comment first = Add("what is this?");
  PublishAgain();

  EXPECT_EQ(ErrorOf([&] {
              AddComment(store_, "lot", 2, {"a puddle", first.id, {}}, "bob");
            }).code(),
            ErrorCode::kNotFound);
  EXPECT_EQ(ErrorOf([&] { DeleteComment(store_, "lot", 2, first.id, As("ann")); }).code(),
            ErrorCode::kNotFound);
}

TEST_F(Comments, AreListedByPages) {
  for (int i = 0; i < 5; ++i) Add(std::to_string(i));

  const std::vector<Comment> page = All({}, {.limit = 3});
  ASSERT_EQ(page.size(), 3u);
  const std::vector<Comment> rest = All({}, {.limit = 3, .before = page.back().sequence});
  ASSERT_EQ(rest.size(), 2u);
  EXPECT_EQ(rest[0].text, "1");
}

TEST_F(Comments, AreChangedByTheirAuthorAlone) {
  const Comment comment = Add("a pudle");

  EXPECT_EQ(ErrorOf([&] { Change(comment, {.text = "mine"}, "bob"); }).code(),
            ErrorCode::kForbidden);
  EXPECT_EQ(ErrorOf([&] { Delete(comment, As("bob")); }).code(), ErrorCode::kForbidden);
  const Comment changed = Change(comment, {.text = "a puddle"});
  EXPECT_EQ(changed.text, "a puddle");
  EXPECT_TRUE(changed.edited_at.has_value());
  EXPECT_EQ(All().front().text, "a puddle");
}

TEST_F(Comments, AreDeletedByAnAdminToo) {
  const Comment comment = Add("not for everybody");

  Delete(comment, As("carl", Role::kAdmin));
  EXPECT_TRUE(All().empty());
}

TEST_F(Comments, ThreadsAreResolvedAndOpenedByAnyone) {
  const Comment first = Add("what is this?"), answer = Answer(first, "a puddle");
  const auto counts = [&] {
    return store_.database.Read(
        [&](Connection& connection) { return CountComments(connection, map_.id); });
  };

  const Comment resolved = Change(first, {.is_resolved = true}, "bob");
  EXPECT_EQ(resolved.resolved_by, "bob");
  EXPECT_TRUE(resolved.resolved_at.has_value());
  EXPECT_EQ(counts().resolved_threads, 1);
  EXPECT_EQ(counts().open_threads, 0);
  EXPECT_EQ(counts().comments, 2);
  EXPECT_FALSE(Change(first, {.is_resolved = false}).resolved_at.has_value());
  EXPECT_EQ(counts().open_threads, 1);
  EXPECT_EQ(ErrorOf([&] { Change(answer, {.is_resolved = true}); }).code(),
            ErrorCode::kInvalidInput);
}

TEST_F(Comments, LeaveATombstoneWhereTheyWereAnswered) {
  const Comment first = Add("what is this?", {.slot = "A-17"}), answer = Answer(first, "a puddle");
  Delete(first);

  const std::vector<Comment> left = All();
  ASSERT_EQ(left.size(), 2u);
  EXPECT_EQ(left[1].text, "");
  EXPECT_TRUE(left[1].deleted_at.has_value());
  EXPECT_EQ(left[1].pin.slot, "A-17") << "the answers are still about it";
  EXPECT_EQ(ErrorOf([&] { Change(first, {.text = "back"}); }).code(), ErrorCode::kConflict);
  EXPECT_EQ(ErrorOf([&] { Delete(first); }).code(), ErrorCode::kNotFound);

  Delete(answer, As("bob"));
  EXPECT_TRUE(All().empty()) << "nothing needs the tombstone any more";
}

TEST_F(Comments, AreGoneWhereTheyWereNot) {
  const Comment first = Add("what is this?"), answer = Answer(first, "a puddle");
  Delete(answer, As("bob"));
  EXPECT_EQ(All().size(), 1u);
  Delete(first);
  EXPECT_TRUE(All().empty());
}

TEST_F(Comments, AreTextThatIsKeptAsItIs) {
  const std::string markup =
      "<img src=x onerror=alert(1)> & \"quotes\" 'x'; DROP TABLE comments;--";
  EXPECT_EQ(Add(markup).text, markup);
  EXPECT_EQ(All().front().text, markup);
  const Error error = ErrorOf([&] { Add(std::string(1 << 20, 'x')); });
  EXPECT_EQ(error.code(), ErrorCode::kInvalidInput);
  EXPECT_STREQ(error.what(), "\"text\" has 1048576 bytes: at most 10000 are kept");
  EXPECT_EQ(ErrorOf([&] { Add("bell\a"); }).code(), ErrorCode::kInvalidInput);
  EXPECT_EQ(ErrorOf([&] { Add(" \n"); }).code(), ErrorCode::kInvalidInput);
}

/// Of all sites.
std::vector<CommentThread> Threads(Store& store, const ThreadFilter& filter = {},
                                   const Page& page = {}) {
  return store.database.Read(
      [&](Connection& connection) { return ListThreads(connection, page, filter); });
}

TEST_F(Comments, ThreadsOfAllVersionsComeByWhatWasSaidLast) {
  const Comment old = Add("old"), young = Add("young");
  PublishAgain();
  AddComment(store_, "lot", 2, {"of version 2", std::nullopt, {}}, "eve");
  Answer(old, "but look", "bob");

  const std::vector<CommentThread> threads = Threads(store_);
  ASSERT_EQ(threads.size(), 3u);
  EXPECT_EQ(threads[0].first.id, old.id);
  EXPECT_EQ(threads[0].num_answers, 1);
  EXPECT_EQ(threads[0].last_author, "bob");
  EXPECT_EQ(threads[1].first.version, 2);
  EXPECT_EQ(threads[2].first.id, young.id);
  EXPECT_EQ(threads[2].last_author, "ann") << "it has no answer";

  const std::vector<CommentThread> rest =
      Threads(store_, {}, {.limit = 1, .before = threads[0].sequence});
  ASSERT_EQ(rest.size(), 1u);
  EXPECT_EQ(rest[0].first.version, 2);
}

TEST_F(Comments, ThreadsAreChosenBySiteStateAndWhetherTheyAreOpen) {
  const Comment open = Add("open"), done = Add("done");
  Change(done, {.is_resolved = true});
  const auto ids = [&](const ThreadFilter& filter) {
    std::vector<std::string> found;
    for (const CommentThread& thread : Threads(store_, filter)) found.push_back(thread.first.id);
    return found;
  };
  EXPECT_EQ(ids({.is_resolved = false}), std::vector{open.id});
  EXPECT_EQ(ids({.is_resolved = true}), std::vector{done.id});
  EXPECT_EQ(ids({.site = "lot"}).size(), 2u);
  EXPECT_TRUE(ids({.site = "elsewhere"}).empty());
  EXPECT_TRUE(ids({.scope = {{"elsewhere"}}}).empty()) << "who may not see a site reads nothing";
  EXPECT_EQ(ids({.states = {ReviewState::kDraft}}).size(), 2u);
  EXPECT_TRUE(ids({.states = {ReviewState::kRejected, ReviewState::kApproved}}).empty());
}

}  // namespace
}  // namespace parkade
