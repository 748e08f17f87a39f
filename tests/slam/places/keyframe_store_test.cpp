#include "slam/places/keyframe_store.h"

#include <gtest/gtest.h>

#include "slam/places/keyframe_bytes.h"

namespace parkade {
namespace {

RigKeyframe KeyframeAt(int second) {
  RigKeyframe keyframe;
  keyframe.time = Timestamp{second * 1'000'000'000LL};
  keyframe.distance = 2.5 * second;
  for (int i = 0; i < second; ++i) {
    KeyframeFeature& feature = keyframe.features.emplace_back();
    feature.origin = {0.1 * i, 1.0 / 3, second / 7.0};
    feature.bearing = Eigen::Vector3d(1, i, 0).normalized();
    feature.image_point = {0.25F, 0.5F};
    if (i % 2 == 0) feature.point = Eigen::Vector3d(i, 2, 3);
  }
  keyframe.descriptors = cv::Mat(second, 32, CV_8UC1, cv::Scalar(second));
  keyframe.views = {cv::Mat(3, 4, CV_8UC1, cv::Scalar(7))};
  keyframe.image_times = {keyframe.time + 0.01};
  keyframe.floor = cv::Mat(5, 5, CV_8UC1, cv::Scalar(second));
  return keyframe;
}

TEST(KeyframeStore, GivesBackWhatWasAddedInAnyOrder) {
  KeyframeStore store;
  for (const int second : {1, 4, 2, 9}) store.Add(KeyframeAt(second));

  for (const int second : {9, 1, 2, 4}) {
    const std::optional<RigKeyframe> found = store.Find(KeyframeAt(second).time);
    ASSERT_TRUE(found);
    EXPECT_EQ(EncodeKeyframes({*found}), EncodeKeyframes({KeyframeAt(second)}));
  }
  EXPECT_TRUE(store.Has(KeyframeAt(4).time));
  EXPECT_FALSE(store.Has(KeyframeAt(3).time));
  EXPECT_FALSE(store.Find(KeyframeAt(3).time));
}

}  // namespace
}  // namespace parkade
