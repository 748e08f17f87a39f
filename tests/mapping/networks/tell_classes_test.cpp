#include "mapping/networks/tell_classes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace parkade {
namespace {

constexpr std::array<float, kNumSurfaceClasses> kOverrated = {1,    1.4F, 1, 1, 1.7F,
                                                              1.4F, 2.4F, 1, 1};

/// Scores of `count` pixels: random, of which some are as high as others, or far apart.
std::vector<std::vector<float>> SomeScores(std::size_t count) {
  std::mt19937 random(3);
  std::vector<std::vector<float>> scores(kNumSurfaceClasses);
  for (std::vector<float>& of_class : scores)
    for (std::size_t i = 0; i < count; ++i) {
      const float spread = i % 7 == 0 ? 100 : 5;
      of_class.push_back(i % 5 == 0
                             ? std::round(std::uniform_real_distribution<float>(-2, 2)(random))
                             : std::uniform_real_distribution<float>(-spread, spread)(random));
    }
  return scores;
}

TEST(TellClasses, SaysWhatASoftmaxSays) {
  for (const std::size_t count : {1, 64, 200}) {
    const std::vector<std::vector<float>> scores = SomeScores(count);
    ClassScores of_class{};
    for (std::size_t k = 0; k < scores.size(); ++k) of_class[k] = scores[k].data();
    std::vector<std::uint8_t> classes(count);
    std::vector<float> log_odds(count);
    TellClasses(of_class, kOverrated, classes, log_odds.data());

    for (std::size_t i = 0; i < count; ++i) {
      std::vector<double> of_pixel;
      for (const std::vector<float>& of_one : scores) of_pixel.push_back(double{of_one[i]});
      const auto best = std::max_element(of_pixel.begin(), of_pixel.end());
      double for_cars = 0, others = 0;
      for (std::size_t k = 0; k < of_pixel.size(); ++k)
        (IsForCars(static_cast<SurfaceClass>(k)) ? for_cars : others) +=
            std::exp(std::max(-55.0, of_pixel[k] - *best)) / double{kOverrated[k]};
      EXPECT_EQ(classes[i], best - of_pixel.begin()) << i;
      const double expected = std::log(for_cars / others);
      EXPECT_NEAR(log_odds[i], expected, 2e-6 * std::max(1.0, std::abs(expected)))
          << i << " of " << count;
    }
  }
}

TEST(TellClasses, APixelWithAScoreThatIsNoNumberSaysNothing) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(),
                  kInfinity = std::numeric_limits<float>::infinity();
  std::vector<std::vector<float>> scores(kNumSurfaceClasses, std::vector<float>(5, 1));
  for (std::vector<float>& of_class : scores) of_class[4] = 2;
  scores[0][4] = 9;
  scores[7][0] = kNan, scores[1][1] = -kNan, scores[0][2] = kInfinity, scores[8][3] = -kInfinity;
  ClassScores of_class{};
  for (std::size_t k = 0; k < scores.size(); ++k) of_class[k] = scores[k].data();
  std::vector<std::uint8_t> classes(5);
  std::vector<float> log_odds(5);
  TellClasses(of_class, kOverrated, classes, log_odds.data());

  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(log_odds[i], 0) << i;
  EXPECT_GT(log_odds[4], 4);
}

}  // namespace
}  // namespace parkade
