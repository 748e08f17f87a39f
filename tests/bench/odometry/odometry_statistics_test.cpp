// The odometry on a few drives without images: what must never get worse. The
// long runs are parkade-odometry-statistics.
#include "tests/bench/odometry/odometry_statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/bench/odometry/odometry_cases.h"

namespace parkade {
namespace {

StatisticsCase CaseNamed(const std::string& name) {
  for (const StatisticsCase& question : StandardCases("lot", 11))
    if (question.name == name) return question;
  ADD_FAILURE() << "no case " << name;
  return {};
}

TEST(OdometryStatistics, ExactRigsDriftLittleAndCoverTheDrive) {
  const StatisticsSummary summary = Summarize(RunCase(CaseNamed("exact"), 2));

  EXPECT_EQ(summary.num_answers, 2);
  EXPECT_EQ(summary.num_failures, 0);
  EXPECT_LT(summary.worst_drift, 0.3);
  EXPECT_GT(summary.coverage, 0.99);
  EXPECT_EQ(summary.num_consistent, 2);
  EXPECT_LT(summary.ms_per_image, 20) << "track mode must stay far quicker than rendering";
}

TEST(OdometryStatistics, HonestTracksMakeHonestCovariances) {
  // White noise of half a pixel, as the tracker declares, and an IMU as its file says: no excuses.
  StatisticsCase question = CaseNamed("exact");
  simulator::TrackModel& model = question.drive.model;
  model.white = 0.35;
  model.blur = model.drift = model.slide = model.slide_across = model.roughness = model.jump = 0;
  model.edges = model.shadow = 0;
  model.crossing_noise = 0.35;

  const StatisticsSummary summary = Summarize(RunCase(question, 2));

  EXPECT_EQ(summary.num_consistent, 2);
  EXPECT_LT(summary.nees_on_the_way, 4);
  EXPECT_GT(summary.nees_on_the_way, 0.25);
}

TEST(OdometryStatistics, NamesFailuresInsteadOfHidingThem) {
  StatisticsRun good, bad, worse;
  good.drift_percent = 0.1;
  bad.drift_percent = 6;
  worse.error = "could not initialize";

  const StatisticsSummary summary = Summarize({good, bad, worse});

  EXPECT_EQ(summary.num_answers, 2);
  EXPECT_EQ(summary.num_failures, 2);
  EXPECT_DOUBLE_EQ(summary.worst_drift, 6);
  EXPECT_DOUBLE_EQ(summary.mean_drift, 3.05);
}

TEST(OdometryStatistics, EveryRunIsInTheJson) {
  StatisticsRun run;
  run.seed = 7;
  run.consistency.push_back({1, 2, 3, 4, 5, 6});

  const nlohmann::json json = ToJson(CaseNamed("off-large"), {run, run});

  EXPECT_EQ(json["case"], "off-large");
  EXPECT_EQ(json["track_mode"]["drive"]["faults"]["extrinsic_rotation_deg"][0], 1);
  ASSERT_EQ(json["runs"].size(), 2u);
  EXPECT_EQ(json["runs"][0]["seed"], 7);
  EXPECT_EQ(json["runs"][0]["nees"][0]["position_error_m"], 6);
}

}  // namespace
}  // namespace parkade
