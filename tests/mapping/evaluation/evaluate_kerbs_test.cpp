#include "mapping/evaluation/evaluate_kerbs.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace parkade {
namespace {

using Eigen::Vector3d;

/// A kerb of ten stones along x, the ground beyond y = 0.
std::vector<TrueKerb> TenStones() {
  std::vector<TrueKerb> truth;
  for (double i = 0; i < 10; ++i) truth.push_back({{i, 0, 0}, {i + 1, 0, 0}, i < 5 ? 0.10 : 0.12});
  return truth;
}

TEST(EvaluateKerbs, CountsLengthsAndErrorsOfHeight) {
  const std::vector<Kerb> found = {{{{0, 0.1, 0}, {8, 0.1, 0}}, 0.11, 0.005},
                                   {{{0, 3, 0}, {2, 3, 0}}, 0.1, 0.005}};
  const KerbEvaluation evaluation = EvaluateKerbs(TenStones(), found);
  EXPECT_NEAR(evaluation.true_length, 10, 1e-9);
  EXPECT_NEAR(evaluation.recall_percent, 84, 5) << "8 m, and the reach of the last point";
  EXPECT_NEAR(evaluation.precision_percent, 80, 1e-9);
  EXPECT_NEAR(evaluation.height_median, 0.01, 1e-9);
  EXPECT_NEAR(evaluation.height_bias, (5 * 0.01 - 3 * 0.01) / 8, 1e-9);
  EXPECT_NEAR(evaluation.height_normalized_rmse, 2, 1e-9);
  EXPECT_EQ(ToJson(evaluation).at("found_length"), evaluation.found_length);
  EXPECT_NE(ToText(evaluation).find("80.0 %"), std::string::npos);
}

TEST(EvaluateKerbs, BlamesNobodyForKerbsFarAwayOrHidden) {
  KerbScope scope;
  scope.path = {{0, 4, 0}, {2, 4, 0}};
  scope.ground.find_seen = [](const std::vector<Vector3d>& points) {
    std::vector<bool> is_seen;
    for (const Vector3d& point : points) {
      EXPECT_GT(point.y(), 0.1) << "the ground on its left is asked for";
      is_seen.push_back(point.x() < 3);
    }
    return is_seen;
  };
  const std::vector<Kerb> found = {{{{0, 0, 0}, {3, 0, 0}}, 0.1, 0.01},
                                   {{{7, 0, 0}, {9, 0, 0}}, 0.12, 0.01}};
  const KerbEvaluation evaluation = EvaluateKerbs(TenStones(), found, scope);
  EXPECT_NEAR(evaluation.true_length, 3, 1e-9);
  EXPECT_NEAR(evaluation.recall_percent, 100, 1e-9);
  EXPECT_NEAR(evaluation.precision_percent, 100, 1e-9) << "one that is found nevertheless is right";
  EXPECT_NEAR(evaluation.height_rmse, 0, 1e-9);
}

TEST(EvaluateKerbs, AKerbOnAnotherDeckIsAnotherKerb) {
  const KerbEvaluation evaluation =
      EvaluateKerbs(TenStones(), {{{{0, 0, 3}, {10, 0, 3}}, 0.1, 0.01}});
  EXPECT_EQ(evaluation.recall_percent, 0);
  EXPECT_EQ(evaluation.precision_percent, 0);
  EXPECT_EQ(EvaluateKerbs({}, {}).recall_percent, 0);
}

}  // namespace
}  // namespace parkade
