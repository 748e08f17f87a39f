#include "slam/sessions/reviewed_links.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "slam/sessions/join_drives.h"
#include "tests/slam/worlds/drive_world.h"

namespace parkade {
namespace {

const std::vector<std::string> kNames = {"a", "b~c", "d:1"};

TEST(FindEnds, ReadsNamesWhateverDrivesAreCalled) {
  EXPECT_EQ(FindEnds("a:3~b~c:17", kNames), (LinkEnds{0, 3, 1, 17}));
  EXPECT_EQ(FindEnds("d:1:4~a:9", kNames), (LinkEnds{0, 9, 2, 4})) << "the earlier drive first";
  EXPECT_EQ(NameOf({1, 2, 2, 4}, kNames), "b~c:2~d:1:4");
  for (const char* id : {"", "a:3", "a:3~a:4", "a:3~e:4", "a:x~d:1:4", "a:3~d:1:", "a:3~d:1:4x"})
    EXPECT_FALSE(FindEnds(id, kNames)) << id;
}

/// Three links between the first two drives.
DrivePair Pair() {
  DrivePair pair{0, 1, {}, {1, 1, 1}, {0, 0, 0}};
  for (size_t i = 0; i < 3; ++i) pair.found.links.push_back({i, 10 + i, 0, {}});
  return pair;
}

TEST(ReviewedLinks, SetRejectedOnesAsideAndMarkForcedOnes) {
  DrivePair pair = Pair();
  ReviewedLinks({{"a:1~b~c:11", "a:9~e:9"}, {"b~c:12~a:2"}}, kNames).Judge(pair);

  ASSERT_EQ(pair.found.links.size(), 2u);
  EXPECT_EQ(pair.found.links[1].keyframe_a, 2u);
  EXPECT_FALSE(pair.IsForced(0));
  EXPECT_TRUE(pair.IsForced(1));
  ASSERT_EQ(pair.rejected.size(), 1u);
  EXPECT_EQ(pair.rejected[0].link.keyframe_b, 11u);
  EXPECT_EQ(pair.num_accepted(), 2);
  EXPECT_EQ(pair.found.rejected, "");
}

TEST(ReviewedLinks, ADecisionNeedsALink) {
  DrivePair pair = Pair();
  ReviewedLinks({{"a:1~b~c:11"}, {}}, kNames).Judge(pair);
  EXPECT_NO_THROW(RequireLinks({{"a:1~b~c:11"}, {"a:0~b~c:10"}}, kNames, {pair}));
  EXPECT_THROW(RequireLinks({{"a:1~b~c:12"}, {}}, kNames, {pair}), Error);
  EXPECT_THROW(RequireLinks({{}, {"a:1~e:1"}}, kNames, {pair}), Error);
}

class ReviewedJoin : public testing::Test {
 protected:
  DriveJoin Join(const LinkReview& review) const {
    return JoinDrives({a_.drive, b_.drive}, {}, {}, {}, ReviewedLinks(review, names_));
  }
  std::string IdOf(const SessionLoop& link) const {
    return NameOf({0, link.keyframe_a, 1, link.keyframe_b}, names_);
  }

  const DriveWorld world_;
  const WorldDrive a_ = world_.Drive(1), b_ = world_.Drive(2);
  const std::vector<std::string> names_ = {"a", "b"};
};

TEST_F(ReviewedJoin, ARejectedLinkJoinsNothingAndIsStillMeasured) {
  const DriveJoin before = Join({});
  const SessionLoop link = before.pairs[0].found.links.at(3);
  const DriveJoin after = Join({{IdOf(link)}, {}});

  EXPECT_EQ(after.pairs[0].found.links.size() + 1, before.pairs[0].found.links.size());
  EXPECT_EQ(after.adjustment.num_links + 1, before.adjustment.num_links);
  ASSERT_EQ(after.pairs[0].rejected.size(), 1u);
  EXPECT_GT(after.pairs[0].rejected[0].chi_squared, 0);
  EXPECT_EQ(after.findings.loops.begin()->second.links.size(), before.pairs[0].found.links.size())
      << "what is kept for later builds knows no review";
  EXPECT_LT(WorstOffset(a_, after.drives[0].site_from_body, b_, after.drives[1].site_from_body),
            0.1);
}

TEST_F(ReviewedJoin, WithoutAnyLinkADriveIsLeftOutAndSaysWhy) {
  LinkReview review;
  const DriveJoin before = Join({});
  for (const SessionLoop& link : before.pairs[0].found.links) review.rejected.push_back(IdOf(link));
  const DriveJoin join = Join(review);

  EXPECT_EQ(join.drives[1].left_out, "a reviewer rejected all links");
  EXPECT_EQ(join.drives[0].left_out, "");
}

TEST_F(ReviewedJoin, AForcedLinkIsBelievedAgainstTheOthers) {
  DriveJoin found = Join({});
  // A link that is a meter off: doubted, unless somebody knows better.
  SessionLoop& wrong = found.findings.loops.begin()->second.links.at(4);
  wrong.pose.a_from_b.translation.x() += 1;
  const auto weight_with = [&](const LinkReview& review) {
    return JoinDrives({a_.drive, b_.drive}, {}, {}, found.findings, ReviewedLinks(review, names_))
        .pairs[0]
        .weights.at(4);
  };
  EXPECT_LT(weight_with({}), 0.5);
  EXPECT_GT(weight_with({{}, {IdOf(wrong)}}), 0.5);
}

TEST_F(ReviewedJoin, AForcedPairThatWasNotFoundIsMeasuredAndJoinsTheDrives) {
  // Nothing is found where more links have to agree than there are.
  SessionLoopOptions strict;
  strict.min_links = 100;
  const auto join_with = [&](const LinkReview& review) {
    return JoinDrives({a_.drive, b_.drive}, {}, strict, {}, ReviewedLinks(review, names_));
  };
  EXPECT_NE(join_with({}).drives[1].left_out, "");

  const LinkReview review{{}, {"a:7~b:7"}};
  const DriveJoin join = join_with(review);
  EXPECT_EQ(join.drives[1].left_out, "");
  ASSERT_EQ(join.pairs[0].found.links.size(), 1u);
  EXPECT_TRUE(join.pairs[0].IsForced(0));
  EXPECT_NO_THROW(RequireLinks(review, names_, join.pairs));
  EXPECT_LT(WorstOffset(a_, join.drives[0].site_from_body, b_, join.drives[1].site_from_body), 0.5);
}

TEST_F(ReviewedJoin, APairThatShowsNothingInCommonCannotBeForced) {
  const WorldDrive elsewhere = DriveWorld({.seed = 9}).Drive(2);
  for (const char* link : {"a:3~b:3", "a:0~b:999"}) {
    const LinkReview review{{}, {link}};
    const DriveJoin join =
        JoinDrives({a_.drive, elsewhere.drive}, {}, {}, {}, ReviewedLinks(review, names_));
    EXPECT_EQ(join.pairs[0].found.links.size(), 0u) << link;
    EXPECT_NE(join.drives[1].left_out, "") << link;
    EXPECT_THROW(RequireLinks(review, names_, join.pairs), Error) << link;
  }
}

}  // namespace
}  // namespace parkade
