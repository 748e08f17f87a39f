#include "mapping/heights/height_field.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "core/error.h"

namespace parkade {
namespace {

using Observations = std::vector<HeightObservation>;

/// Observations every 20 cm over [0, 10] x [0, 6].
Observations Observe(const std::function<double(double, double)>& height, double weight) {
  Observations observations;
  for (double x = 0.1; x < 10; x += 0.2)
    for (double y = 0.1; y < 6; y += 0.2) observations.push_back({{x, y, height(x, y)}, weight});
  return observations;
}

double HeightOf(const HeightField& field, double x, double y, double z) {
  const int patch = field.FindPatch({x, y, z});
  EXPECT_NE(patch, HeightField::kNone);
  return patch == HeightField::kNone ? NAN : field.HeightAt(patch, {x, y});
}

TEST(HeightField, ReproducesAnInclinedPlaneExactly) {
  const auto plane = [](double x, double y) { return 3 + 0.1 * x - 0.05 * y; };

  const HeightField field(Observe(plane, 1000), {});

  for (double x = 0.3; x < 9.8; x += 0.37)
    for (double y = 0.3; y < 5.8; y += 0.41)
      EXPECT_NEAR(HeightOf(field, x, y, plane(x, y)), plane(x, y), 1e-3);
}

TEST(HeightField, SureObservationsBeatManyUnsureOnes) {
  Observations observations = Observe([](double, double) { return 0.3; }, 4);
  for (double x = 0.1; x < 10; x += 0.2) observations.push_back({{x, 3, 0.0}, 10000});

  const HeightField field(observations, {});

  EXPECT_NEAR(HeightOf(field, 5, 3, 0), 0, 0.01);
}

TEST(HeightField, AKerbStaysAStepWhereThePlateMayBreak) {
  const auto kerb = [](double, double y) { return y < 3 ? 0.0 : 0.12; };
  const Observations observations = Observe(kerb, 5000);

  const HeightField smooth(observations, {}), stepped(observations, {.has_steps = true});

  const auto error = [&](const HeightField& field, double y) {
    return std::abs(HeightOf(field, 5.1, y, kerb(5.1, y)) - kerb(5.1, y));
  };
  for (const double y : {2.3, 3.7}) {
    EXPECT_GT(error(smooth, y), 0.008) << y;
    EXPECT_LT(error(stepped, y), 0.006) << y;
  }
}

TEST(HeightField, KnowsWhatViewsMeasuredInAPatch) {
  Observations observations = Observe([](double, double) { return 0.0; }, 100);
  observations.push_back({{5.1, 3.1, 0.05}, 1000, 0.02, true});
  observations.push_back({{5.15, 3.1, 0.08}, 500, 0.02, true});

  const HeightField field(observations, {});

  const MeasuredHeight& there = field.MeasuredIn(field.FindPatch({5.1, 3.1, 0}));
  EXPECT_NEAR(there.height, 0.06, 1e-9);
  EXPECT_NEAR(there.weight, 1500, 1e-9);
  EXPECT_EQ(field.MeasuredIn(field.FindPatch({2.1, 1.1, 0})).weight, 0);
}

TEST(HeightField, AStripIsContinuedSidewaysWhereOnlyGuessesAre) {
  // A road of constant cross slope, known under the axles; beside it weak guesses that ignore the
  // slope.
  Observations observations;
  for (double x = 0.1; x < 10; x += 0.2)
    for (const double y : {2.2, 3.0, 3.8}) observations.push_back({{x, y, 0.04 * y}, 10000});
  for (double x = 0.1; x < 10; x += 0.2) observations.push_back({{x, 5.0, 0.16}, 2});

  const HeightField field(observations, {});

  EXPECT_NEAR(HeightOf(field, 5, 5.3, 0.2), 0.04 * 5.3, 0.025);
}

TEST(HeightField, AFarViewThatIsFarOffLosesItsSay) {
  Observations observations = Observe([](double, double) { return 0.0; }, 400);
  for (double x = 0.1; x < 10; x += 0.2)
    for (double y = 0.1; y < 6; y += 0.2) observations.push_back({{x, y, 0.6}, 100});

  const HeightField field(observations, {});

  EXPECT_NEAR(HeightOf(field, 5, 3, 0), 0, 0.02) << "the mean would be 0.12";
}

TEST(HeightField, WeighedByAnEarlierFieldItIsTheSame) {
  Observations observations = Observe([](double x, double) { return 0.02 * x; }, 400);
  for (double x = 0.1; x < 10; x += 0.2)
    for (double y = 0.1; y < 6; y += 0.2) observations.push_back({{x, y, 0.02 * x + 0.6}, 100});
  const HeightField earlier(observations, {});

  const HeightField field(observations, {}, &earlier);

  const HeightField alone(observations, {});
  for (double x = 0.3; x < 9.8; x += 0.37)
    EXPECT_NEAR(HeightOf(field, x, 3, 0.02 * x), HeightOf(alone, x, 3, 0.02 * x), 1e-3);
}

TEST(HeightField, WhatIsLearntLaterMovesItOffAnEarlierField) {
  Observations observations = Observe([](double, double) { return 0.0; }, 25);
  const HeightField earlier(observations, {});
  const Observations learnt = Observe([](double, double) { return 0.15; }, 10000);
  observations.insert(observations.end(), learnt.begin(), learnt.end());

  const HeightField field(observations, {}, &earlier);

  EXPECT_NEAR(HeightOf(field, 5, 3, 0.1), 0.15, 2e-3);
}

TEST(HeightField, TwoDecksStayApart) {
  Observations observations = Observe([](double, double) { return 0.0; }, 1000);
  const Observations upper = Observe([](double, double) { return 2.8; }, 500);
  observations.insert(observations.end(), upper.begin(), upper.end());

  const HeightField field(observations, {});

  EXPECT_NEAR(HeightOf(field, 5, 3, 0.2), 0.0, 1e-3);
  EXPECT_NEAR(HeightOf(field, 5, 3, 2.5), 2.8, 1e-3);
  EXPECT_NE(field.FindPatch({5, 3, 0.2}), field.FindPatch({5, 3, 2.5}));
}

TEST(PatchFinder, FindsWhatTheFieldFinds) {
  Observations observations = Observe([](double x, double y) { return 0.05 * x + 0.02 * y; }, 1000);
  for (const HeightObservation& above : Observe([](double, double) { return 2.8; }, 500))
    if (above.point_in_site.x() < 4) observations.push_back(above);
  const HeightField field(observations, {});
  PatchFinder patches(field);

  std::mt19937 random(5);
  std::normal_distribution<double> step(0, 0.15);
  std::set<int> found;
  Eigen::Vector3d point(5, 3, 0.5);
  for (int i = 0; i < 20'000; ++i) {
    if (i % 500 == 0) point = {5, 3, 0.5};
    point += Eigen::Vector3d(step(random), step(random), step(random));
    double height = -1, expected_height = -1;
    const int expected = field.FindPatch(point, expected_height);
    ASSERT_EQ(patches.Find(point, height), expected) << point.transpose();
    ASSERT_EQ(height, expected_height);
    found.insert(expected);
  }
  EXPECT_GT(found.size(), 400U);
  EXPECT_TRUE(found.contains(HeightField::kNone));
}

TEST(HeightField, NothingIsKnownFarFromObservations) {
  const HeightField field(Observe([](double, double) { return 0.0; }, 1000), {});

  EXPECT_EQ(field.FindPatch({20, 3, 0}), HeightField::kNone);
  EXPECT_EQ(field.FindPatch({5, 3, 6}), HeightField::kNone);
}

TEST(HeightField, SigmaIsThatOfTheSurestObservationNearby) {
  Observations observations = Observe([](double, double) { return 0.0; }, 4);
  observations.push_back({{5.01, 3.01, 0}, 10000});

  const HeightField field(observations, {});

  EXPECT_NEAR(field.SigmaOf(field.FindPatch({5.01, 3.01, 0})), 0.01, 1e-9);
  EXPECT_NEAR(field.SigmaOf(field.FindPatch({1, 1, 0})), 0.5, 1e-9);
}

TEST(HeightField, WithoutObservationsItIsEmpty) {
  const HeightField field({}, {});
  EXPECT_EQ(field.num_patches(), 0);
  EXPECT_EQ(field.FindPatch({0, 0, 0}), HeightField::kNone);
}

TEST(HeightField, NegativeCoordinatesAreAsGoodAsOthers) {
  Observations observations;
  for (double x = -5; x < 5; x += 0.15)
    for (double y = -5; y < 5; y += 0.15)
      observations.push_back({{x, y, 0.02 * x - 0.03 * y}, 1000});

  const HeightField field(observations, {});

  EXPECT_NEAR(HeightOf(field, -3.3, -2.1, 0), 0.02 * -3.3 + 0.03 * 2.1, 1e-3);
}

TEST(HeightField, RejectsNodesWithoutDistance) {
  HeightFieldOptions options;
  options.spacing = 0;
  EXPECT_THROW(options.Validate(), Error);
}

}  // namespace
}  // namespace parkade
