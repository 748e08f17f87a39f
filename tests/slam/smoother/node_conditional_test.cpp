#include "slam/smoother/node_conditional.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

StateConditional RandomConditional(Eigen::Index own, Eigen::Index rest) {
  StateConditional conditional;
  conditional.own = Eigen::MatrixXf::Random(own, own);
  conditional.to_rest = Eigen::MatrixXf::Random(own, rest);
  conditional.offset = Eigen::VectorXf::Random(own);
  conditional.offset_covariance = Eigen::MatrixXf::Random(own, own);
  conditional.score_with_offset = Eigen::MatrixXf::Random(rest, own);
  conditional.offset_sensitivity = Eigen::MatrixXf::Random(own, 18);
  conditional.states.push_back({{StateName::Kind::kMotion, 12}, {1, 2, 3, 4, 5, 6, 7, 8, 9}});
  for (Eigen::Index i = 0; i < rest; ++i)
    conditional.rest.push_back({{StateName::Kind::kTiming, i}, {0.1, 0.2}});
  return conditional;
}

void ExpectEqual(const std::vector<PriorBlock>& a, const std::vector<PriorBlock>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].name, b[i].name);
    EXPECT_EQ(a[i].at, b[i].at);
  }
}

void ExpectEqual(const StateConditional& a, const StateConditional& b) {
  EXPECT_TRUE(a.own == b.own);
  ASSERT_EQ(a.to_rest.cols(), b.to_rest.cols());
  EXPECT_TRUE(a.to_rest == b.to_rest);
  EXPECT_TRUE(a.offset == b.offset);
  EXPECT_TRUE(a.offset_covariance == b.offset_covariance);
  EXPECT_TRUE(a.score_with_offset == b.score_with_offset);
  EXPECT_TRUE(a.offset_sensitivity == b.offset_sensitivity);
  ExpectEqual(a.states, b.states);
  ExpectEqual(a.rest, b.rest);
}

TEST(ConditionalStore, GivesBackWhatItWasGivenToTheLastBit) {
  std::vector<NodeConditionals> given(3);
  given[0].own = RandomConditional(15, 90);
  given[1].own = RandomConditional(15, 0);
  given[1].reopened = {RandomConditional(8, 3), RandomConditional(6, 1)};
  ConditionalStore store;
  for (const NodeConditionals& conditionals : given) store.Add(conditionals);

  ASSERT_EQ(store.size(), given.size());
  for (size_t i = given.size(); i-- > 0;) {
    const NodeConditionals read = store[i];
    ASSERT_EQ(read.own.has_value(), given[i].own.has_value());
    if (read.own) ExpectEqual(*read.own, *given[i].own);
    ASSERT_EQ(read.reopened.size(), given[i].reopened.size());
    for (size_t k = 0; k < read.reopened.size(); ++k)
      ExpectEqual(read.reopened[k], given[i].reopened[k]);
  }
}

}  // namespace
}  // namespace parkade
