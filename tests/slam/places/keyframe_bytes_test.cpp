#include "slam/places/keyframe_bytes.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "core/error.h"
#include "tests/slam/worlds/drive_world.h"

namespace parkade {
namespace {

TEST(KeyframeBytes, ComeBackWithEveryBit) {
  std::vector<RigKeyframe> keyframes = DriveWorld({.floor_seed = 1}).Drive(1).drive.keyframes;
  keyframes[5].features[9].image_point = {0.25F, 0.75F};
  keyframes[5].image_times = {Timestamp{3}, Timestamp{4}};
  const std::string bytes = EncodeKeyframes(keyframes);
  const std::vector<RigKeyframe> read = DecodeKeyframes(bytes);
  EXPECT_EQ(cv::norm(read[5].floor, keyframes[5].floor, cv::NORM_INF), 0);
  ASSERT_EQ(read.size(), keyframes.size());
  ASSERT_EQ(read[5].features.size(), keyframes[5].features.size());
  EXPECT_EQ(read[5].features[9].bearing, keyframes[5].features[9].bearing);
  EXPECT_EQ(read[5].features[9].point, keyframes[5].features[9].point);
  EXPECT_EQ(read[5].features[9].image_point, keyframes[5].features[9].image_point);
  EXPECT_EQ(read[5].image_times, keyframes[5].image_times);
  EXPECT_EQ(read[5].odom_from_keyframe.Matrix(), keyframes[5].odom_from_keyframe.Matrix());
  EXPECT_EQ(EncodeKeyframes(read), bytes);
}

// Places of maps that older versions made end before the image points.
TEST(KeyframeBytes, OfAnOlderVersionHaveNoImagePoints) {
  std::vector<RigKeyframe> keyframes = DriveWorld({.floor_seed = 1}).Drive(1).drive.keyframes;
  const std::string bytes = EncodeKeyframes(keyframes);
  size_t trailer = sizeof(std::uint64_t);
  for (const RigKeyframe& keyframe : keyframes)
    trailer += 2 * sizeof(std::uint64_t) + keyframe.image_times.size() * sizeof(Timestamp) +
               keyframe.features.size() * sizeof(Eigen::Vector2f);
  const std::vector<RigKeyframe> read =
      DecodeKeyframes(std::string_view(bytes).substr(0, bytes.size() - trailer));
  ASSERT_EQ(read.size(), keyframes.size());
  EXPECT_EQ(cv::norm(read[5].floor, keyframes[5].floor, cv::NORM_INF), 0);
  EXPECT_LT(read[5].features[9].image_point.x(), 0);
}

TEST(KeyframeBytes, WhatIsCutOffIsNoResult) {
  const std::string bytes = EncodeKeyframes(DriveWorld().Drive(1).drive.keyframes);
  for (const size_t length : {size_t{0}, size_t{7}, bytes.size() / 2, bytes.size() - 1})
    EXPECT_THROW(DecodeKeyframes(std::string_view(bytes).substr(0, length)), Error) << length;
  EXPECT_THROW(DecodeKeyframes(bytes + "x"), Error);
}

}  // namespace
}  // namespace parkade
