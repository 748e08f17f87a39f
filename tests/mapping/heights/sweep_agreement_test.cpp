#include "mapping/heights/sweep_agreement.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

/// Misfits of a sweep that dips by `depth` to a parabola about step `center`.
std::vector<double> DipAt(double center, double depth, int count = 21) {
  std::vector<double> misfits;
  for (int i = 0; i < count; ++i)
    misfits.push_back(1 - depth * std::max(0.0, 1 - 0.04 * (i - center) * (i - center)));
  return misfits;
}

TEST(Agreement, TheMisfitIsOneWhereHeightsDoNotMatter) {
  EXPECT_EQ(Agreement{}.Misfit(), 1);
  const Agreement alike{
      .residual = 90, .total = 100, .weight = 100, .num_samples = 100, .num_cells = 10};
  EXPECT_DOUBLE_EQ(alike.Misfit(), 1) << "chance explains a tenth with a tenth of the freedom";
  Agreement of_rows = alike;
  of_rows.num_means = 10;
  EXPECT_DOUBLE_EQ(of_rows.Misfit(), 0.9);
}

TEST(Agreement, SumsCountWhatEachCounts) {
  Agreement sum{.residual = 1, .total = 2, .weight = 3, .num_samples = 4, .num_cells = 5};
  sum.Add({.residual = 10,
           .total = 20,
           .weight = 30,
           .num_samples = 40,
           .num_cells = 50,
           .num_means = 60});
  EXPECT_EQ(sum.residual, 11);
  EXPECT_EQ(sum.total, 22);
  EXPECT_EQ(sum.weight, 33);
  EXPECT_EQ(sum.num_samples, 44);
  EXPECT_EQ(sum.num_cells, 55);
  EXPECT_EQ(sum.num_means, 60);
}

/// Heights at which views differ by these squares, of 10 each that they show.
std::vector<Agreement> DifferingBy(const std::vector<float>& squares) {
  std::vector<Agreement> agreements;
  for (const float square : squares)
    agreements.push_back({.residual = 50 * square,
                          .total = 1000,
                          .weight = 100,
                          .num_samples = 100,
                          .num_cells = 50});
  return agreements;
}

TEST(MisfitsOf, ComparesWithWhatWouldBeWrong) {
  const std::vector<double> dip = MisfitsOf(DifferingBy({8, 6, 1, 12, 5}), 0, 1);
  EXPECT_EQ(dip[0], 1) << "nothing is known of what lies below";
  EXPECT_DOUBLE_EQ(dip[1], 0.75) << "lower, they differ by 8";
  EXPECT_DOUBLE_EQ(dip[2], 0.125);
  EXPECT_EQ(dip[3], 1);
  EXPECT_EQ(dip[4], 1);
  EXPECT_DOUBLE_EQ(MisfitsOf(DifferingBy({20, 1, 30}), 0, 1)[1], 0.1)
      << "by 10 they would by chance";
  EXPECT_DOUBLE_EQ(MisfitsOf(DifferingBy({20, 1, 30}), 2, 1)[1], 0.25) << "3 of 12";
}

TEST(MisfitsOf, WhatLooksAlikeAtAllHeightsTellsNone) {
  for (const double misfit : MisfitsOf(DifferingBy({0, 0, 0, 0}), 0, 1)) EXPECT_EQ(misfit, 1);
  for (const double misfit : MisfitsOf(DifferingBy({1, 2, 3, 4}), 1, 1)) EXPECT_EQ(misfit, 1);
  for (const double misfit : MisfitsOf(DifferingBy({4, 1, 4}), 1, 51)) EXPECT_EQ(misfit, 1);
}

TEST(IsSeenWell, AsksForSamplesCellsAndContrast) {
  const Agreement seen{.total = 400, .weight = 100, .num_samples = 100, .num_cells = 20};
  EXPECT_TRUE(IsSeenWell(seen, {5, 20, 2}));
  EXPECT_FALSE(IsSeenWell(seen, {5.1, 20, 2}));
  EXPECT_FALSE(IsSeenWell(seen, {5, 21, 2}));
  EXPECT_FALSE(IsSeenWell(seen, {5, 20, 2.1}));
}

TEST(IsClear, ADipMustBeDeepAndTheOnlyOne) {
  const SweepClarity clarity{.max_misfit = 0.8, .max_rivalry = 0.9, .rival_steps = 4};
  EXPECT_TRUE(IsClear(DipAt(10, 0.5), 10, clarity));
  EXPECT_FALSE(IsClear(DipAt(10, 0.1), 10, clarity));
  std::vector<double> two = DipAt(10, 0.5, 31);
  two[20] = 0.53;
  EXPECT_FALSE(IsClear(two, 10, clarity));
  two[20] = 0.6;
  EXPECT_TRUE(IsClear(two, 10, clarity)) << "the other is not as deep";
}

TEST(FitMinimum, LiesBetweenTheStepsWhereTheParabolaIsLowest) {
  const std::vector<double> misfits = DipAt(10.3, 0.5);
  const std::optional<SweepMinimum> minimum = FitMinimum(misfits, 10, 0.01, 200);
  ASSERT_TRUE(minimum);
  EXPECT_NEAR(minimum->offset, 0.003, 1e-9);
  // Second derivative 2 * 0.5 * 0.04 per step^2.
  EXPECT_NEAR(minimum->variance, 4 * 2 * misfits[10] * 1e-4 / (0.04 * 200), 1e-9);
}

TEST(FitMinimum, WhereNothingCurvesThereIsNone) {
  EXPECT_FALSE(FitMinimum(std::vector<double>{1, 1, 1}, 1, 0.01, 200));
}

}  // namespace
}  // namespace parkade
