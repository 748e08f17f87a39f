#include "slam/places/place_recognition.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <set>

namespace parkade {
namespace {

/// Keyframes whose descriptors are drawn from a few, so that they share words.
std::vector<RigKeyframe> AlikeKeyframes(int count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<RigKeyframe> keyframes(static_cast<size_t>(count));
  for (RigKeyframe& keyframe : keyframes) {
    keyframe.descriptors = cv::Mat(20, 32, CV_8UC1);
    for (int row = 0; row < 20; ++row) {
      std::mt19937 look(random() % 40);
      for (int column = 0; column < 32; ++column)
        keyframe.descriptors.at<std::uint8_t>(row, column) = static_cast<std::uint8_t>(look());
    }
  }
  return keyframes;
}

/// Cosine of the tf-idf weights of two sets of words among all.
double SlowScore(const std::vector<std::vector<std::uint32_t>>& all, size_t a, size_t b) {
  std::map<std::uint32_t, double> count;
  for (const auto& words : all)
    for (const std::uint32_t word : words) ++count[word];
  const auto weight = [&](std::uint32_t word) {
    return std::pow(std::log(static_cast<double>(all.size()) / count.at(word)), 2);
  };
  const auto norm = [&](size_t of) {
    double sum = 0;
    for (const std::uint32_t word : all[of]) sum += weight(word);
    return std::sqrt(sum);
  };
  double sum = 0;
  const std::set<std::uint32_t> of_b(all[b].begin(), all[b].end());
  for (const std::uint32_t word : all[a])
    if (of_b.contains(word)) sum += weight(word);
  return sum / (norm(a) * norm(b));
}

TEST(FindAlikePlaces, ScoresAreCosinesOfWords) {
  const PlaceWords words(AlikeKeyframes(12, 3));
  const std::vector<PlaceCandidate> found = FindAlikePlaces(
      words, [](size_t, size_t) { return true; }, 4);
  ASSERT_GT(found.size(), 30u);
  for (const PlaceCandidate& place : found) {
    ASSERT_LT(place.earlier, place.later);
    ASSERT_NEAR(place.score, SlowScore(words.of_keyframes(), place.earlier, place.later), 1e-12);
    size_t num_better = 0;
    for (size_t other = 0; other < place.later; ++other)
      num_better += SlowScore(words.of_keyframes(), other, place.later) > place.score + 1e-12;
    EXPECT_LT(num_better, 4u);
  }
}

TEST(FindAlikePlaces, OfTwoDrivesTellsTheirOwnIndices) {
  const std::vector<RigKeyframe> a = AlikeKeyframes(7, 5), b = AlikeKeyframes(9, 6);
  const PlaceWords words_a(a), words_b(b);
  std::vector<std::vector<std::uint32_t>> all = words_a.of_keyframes();
  all.insert(all.end(), words_b.of_keyframes().begin(), words_b.of_keyframes().end());
  const std::vector<PlaceCandidate> found = FindAlikePlaces(
      words_a, words_b, [](size_t earlier, size_t later) { return earlier < 7 && later < 9; }, 2);
  ASSERT_EQ(found.size(), 18u);
  for (const PlaceCandidate& place : found)
    EXPECT_NEAR(place.score, SlowScore(all, place.earlier, 7 + place.later), 1e-12);
}

}  // namespace
}  // namespace parkade
