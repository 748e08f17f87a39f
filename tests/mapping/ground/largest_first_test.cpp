#include "mapping/ground/largest_first.h"

#include <gtest/gtest.h>

#include <vector>

namespace parkade {
namespace {

TEST(ParallelMapLargestFirst, ResultsAreInOrder) {
  const std::vector<int> sizes{3, 9, 1, 9, 5};
  const std::vector<int> doubled = ParallelMapLargestFirst(
      sizes.size(), [&](std::size_t i) { return sizes[i]; },
      [&](std::size_t i) { return 2 * sizes[i]; });
  EXPECT_EQ(doubled, (std::vector<int>{6, 18, 2, 18, 10}));
}

TEST(ParallelMapLargestFirst, TheLargestBegin) {
  const std::vector<int> sizes{3, 9, 1, 9, 5};
  std::vector<int> begun;
  const auto begin = [&](std::size_t i) {
    begun.push_back(sizes[i]);
    return i;
  };
  ParallelFor(2, [&](std::size_t which) {  // inside of which all goes one after the other
    if (which == 0)
      ParallelMapLargestFirst(
          sizes.size(), [&](std::size_t i) { return sizes[i]; }, begin);
  });
  EXPECT_EQ(begun, (std::vector<int>{9, 9, 5, 3, 1}));
}

TEST(ParallelMapLargestFirst, OfNothingIsNothing) {
  EXPECT_TRUE(ParallelMapLargestFirst(
                  0, [](std::size_t i) { return i; }, [](std::size_t i) { return i; })
                  .empty());
}

}  // namespace
}  // namespace parkade
