#include "mapping/ground/patch_index.h"

#include <gtest/gtest.h>

#include <random>

namespace parkade {
namespace {

/// All things at a place, as the index tells them.
std::vector<int> At(const PatchIndex& index, int x, int y) {
  std::vector<int> things;
  for (int thing = index.First(x, y); thing != PatchIndex::kNone; thing = index.Next(thing))
    things.push_back(thing);
  return things;
}

TEST(PatchIndex, FindsWhatAPlainMapFinds) {
  std::mt19937 random(5);
  const auto draw = [&](int reach) {
    return std::uniform_int_distribution<int>(-reach, reach)(random);
  };
  for (const int reach : {3, 300, 20'000, 2'000'000'000}) {
    PatchIndex index;
    std::map<std::pair<int, int>, std::vector<int>> plain;
    for (int thing = 0; thing < 2000; ++thing) {
      // Most lie near, a few far off, so that the table grows and is given up.
      const int spread = thing % 50 == 0 ? reach : std::min(reach, 200);
      const int x = draw(spread), y = draw(spread);
      index.Add(x, y);
      plain[{x, y}].push_back(thing);
    }
    for (const auto& [at, things] : plain) EXPECT_EQ(At(index, at.first, at.second), things);
    for (int i = 0; i < 1000; ++i) {
      const int x = draw(reach), y = draw(reach);
      const auto found = plain.find({x, y});
      EXPECT_EQ(At(index, x, y), found == plain.end() ? std::vector<int>{} : found->second);
    }
  }
}

}  // namespace
}  // namespace parkade
