#include "slam/places/describe_keyframes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "slam/places/estimate_rig_pose.h"
#include "slam/places/triangulate_keyframes.h"
#include "tests/slam/worlds/room_log.h"

namespace parkade {
namespace {

TEST(DescribeKeyframes, KeyframeByKeyframeItGivesWhatAllAtOnceGive) {
  const RoomLog log(100);
  const KeyframeOptions options{.spacing = RoomLog::kStep - 1e-6};
  const std::vector<RigKeyframe> chosen = ChooseKeyframes(log.Truth(), options);
  std::vector<bool> is_wanted(chosen.size(), true);
  for (size_t i = 60; i < 70; ++i) is_wanted[i] = false;  // though this log shows them
  std::vector<RigKeyframe> keyframes;
  std::vector<int> read_before;
  DescribeKeyframes(log, log.Truth(), options, is_wanted, chosen, [&](RigKeyframe&& keyframe) {
    keyframes.push_back(std::move(keyframe));
    read_before.push_back(log.num_read());
  });

  ASSERT_EQ(keyframes.size(), chosen.size());
  size_t num_features = 0, num_points = 0;
  for (size_t i = 0; i < keyframes.size(); ++i) {
    EXPECT_EQ(keyframes[i].time, chosen[i].time);
    EXPECT_EQ(keyframes[i].descriptors.rows, static_cast<int>(keyframes[i].features.size()));
    EXPECT_EQ(keyframes[i].views.size(), 1U);
    EXPECT_FALSE(keyframes[i].floor.empty());
    const std::vector<KeyframeFeature> expected =
        TriangulateFeatures(keyframes, i, options);  // of all of them
    ASSERT_EQ(keyframes[i].features.size(), expected.size());
    for (size_t k = 0; k < expected.size(); ++k) {
      ASSERT_EQ(keyframes[i].features[k].point, expected[k].point) << i << ", " << k;
      ASSERT_EQ(keyframes[i].features[k].depth_sigma, expected[k].depth_sigma);
      num_points += expected[k].point.has_value();
    }
    num_features += expected.size();
  }
  EXPECT_GT(num_features, 50 * keyframes.size());
  EXPECT_GT(num_points, num_features / 10) << "neighbors see the same";
  // Only some keyframes of the drive so far wait: they do not become more as the drive becomes
  // longer.
  for (size_t i = 0; i < keyframes.size(); ++i) EXPECT_LT(read_before[i], static_cast<int>(i) + 60);
}

std::vector<RigKeyframe> Described(const RoomLog& log, const KeyframeOptions& options) {
  const std::vector<RigKeyframe> chosen = ChooseKeyframes(log.Truth(), options);
  std::vector<RigKeyframe> keyframes;
  DescribeKeyframes(log, log.Truth(), options, std::vector<bool>(chosen.size(), true), chosen,
                    [&](RigKeyframe&& keyframe) { keyframes.push_back(std::move(keyframe)); });
  return keyframes;
}

TEST(DescribeKeyframes, CamerasOfTwiceTheResolutionFindTheSameCorners) {
  const KeyframeOptions options{.spacing = RoomLog::kStep - 1e-6};
  const int once = std::numeric_limits<int>::max();
  const std::vector<RigKeyframe> coarse = Described(RoomLog(5, once, 0.5), options),
                                 fine = Described(RoomLog(5, once, 1), options);
  ASSERT_EQ(coarse.size(), fine.size());
  size_t num_right = 0;
  for (size_t i = 0; i < coarse.size(); ++i)
    for (const FeatureMatch& match : MatchKeyframes(coarse[i], fine[i], {})) {
      const double cosine =
          coarse[i].features[match.a].bearing.dot(fine[i].features[match.b].bearing);
      num_right += cosine > std::cos(0.01);
    }
  EXPECT_GT(num_right, 26 * coarse.size());
}

}  // namespace
}  // namespace parkade
