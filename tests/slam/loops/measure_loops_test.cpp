#include "slam/loops/measure_loops.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/error.h"
#include "slam/baselines/relative_pose_baselines.h"
#include "slam/places/estimate_rig_pose.h"
#include "tests/slam/worlds/place_world.h"

namespace parkade {
namespace {

constexpr size_t kNumVisits = 14;

/// Visits to one spot, 11 cm apart, of which one camera has images, each with a gray of its own.
std::vector<RigKeyframe> Visits() {
  std::vector<RigKeyframe> keyframes;
  for (size_t i = 0; i < kNumVisits; ++i) {
    const auto off = static_cast<double>(i);
    RigKeyframe keyframe =
        MakePlaceWorld({.a_from_b = {ExpSo3({0, 0, 0.02 * off}), {0.1 * off, 0.05 * off, 0}}}).b;
    keyframe.time = Timestamp{static_cast<std::int64_t>(i) * 1'000'000'000};
    keyframe.distance = 50 * off;
    keyframe.views = {cv::Mat(40, 60, CV_8UC1, cv::Scalar(10.0 * off)), cv::Mat()};
    keyframes.push_back(std::move(keyframe));
  }
  return keyframes;
}

class MeasureLoopsBy : public testing::TestWithParam<std::string> {};

// More candidates than are in memory at once.
TEST_P(MeasureLoopsBy, MeasuresAsIfAllKeyframesWereInMemory) {
  LoopOptions options;
  options.method = GetParam();
  const std::vector<RigKeyframe> visits = Visits();
  KeyframeStore described;
  std::vector<RigKeyframe> bare;
  for (const RigKeyframe& visit : visits) {
    described.Add(visit);
    RigKeyframe& keyframe = bare.emplace_back();
    keyframe.time = visit.time;
    keyframe.distance = visit.distance;
    keyframe.odom_from_keyframe = visit.odom_from_keyframe;
  }
  std::vector<PlaceCandidate> candidates;
  for (size_t later = 0; later < kNumVisits; ++later)
    for (size_t earlier = 0; earlier < later; ++earlier)
      candidates.push_back({earlier, later, 0.5});
  ASSERT_GT(candidates.size(), 80u);

  const auto [loops, views] = MeasureLoops(described, bare, candidates, options);

  ASSERT_EQ(loops.size(), candidates.size());
  size_t num_measured = 0;
  for (size_t i = 0; i < loops.size(); ++i) {
    const RigKeyframe &earlier = visits[candidates[i].earlier],
                      &later = visits[candidates[i].later];
    const std::vector<FeatureMatch> matches = MatchKeyframes(earlier, later, {});
    const RelativePose expected = GetParam() == "rig"
                                      ? EstimateRigPose(earlier, later, matches, {})
                                      : EstimatePnpPose(earlier, later, matches, {});
    EXPECT_EQ(loops[i].earlier_keyframe, candidates[i].earlier);
    EXPECT_EQ(loops[i].way, later.distance - earlier.distance);
    EXPECT_EQ(loops[i].pose.rejected, expected.rejected);
    EXPECT_EQ(loops[i].pose.a_from_b.Matrix(), expected.a_from_b.Matrix());
    EXPECT_EQ(loops[i].pose.information, expected.information);
    num_measured += expected.rejected.empty();
    for (const auto& [keyframe, camera] :
         {std::pair(loops[i].earlier_keyframe, loops[i].earlier_camera),
          std::pair(loops[i].later_keyframe, loops[i].later_camera)})
      EXPECT_EQ(views.contains({keyframe, camera}), camera == 0);
  }
  EXPECT_GT(num_measured, candidates.size() / 2);
  ASSERT_FALSE(views.empty());
  for (const auto& [end, jpeg] : views) {
    const cv::Mat view =
        cv::imdecode(std::vector<uchar>(jpeg.begin(), jpeg.end()), cv::IMREAD_GRAYSCALE);
    ASSERT_EQ(view.size(), cv::Size(60, 40));
    EXPECT_NEAR(cv::mean(view)[0], 10.0 * static_cast<double>(end.first), 2);
  }
}
INSTANTIATE_TEST_SUITE_P(Methods, MeasureLoopsBy, testing::Values("rig", "pnp"));

TEST(MeasureLoops, KeyframesThatNobodyDescribedAreAnError) {
  const std::vector<RigKeyframe> visits = Visits();
  KeyframeStore described;
  described.Add(visits[0]);
  EXPECT_THROW(MeasureLoops(described, visits, {{{0, 1, 0}}}, {}), Error);
}

}  // namespace
}  // namespace parkade
