#include "slam/places/hamming.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <random>

namespace parkade {
namespace {

cv::Mat RandomDescriptors(int rows, std::uint32_t seed) {
  std::mt19937 random(seed);
  cv::Mat descriptors(rows, kDescriptorBytes, CV_8UC1);
  for (int row = 0; row < rows; ++row)
    for (int i = 0; i < kDescriptorBytes; ++i)
      descriptors.at<uchar>(row, i) = static_cast<uchar>(random());
  return descriptors;
}

TEST(HammingDistance, CountsBitsAsOpenCvDoes) {
  const cv::Mat descriptors = RandomDescriptors(50, 1);
  for (int row = 1; row < descriptors.rows; ++row)
    EXPECT_EQ(HammingDistance(descriptors.ptr(row - 1), descriptors.ptr(row)),
              static_cast<int>(
                  cv::norm(descriptors.row(row - 1), descriptors.row(row), cv::NORM_HAMMING)));
}

TEST(DescriptorSet, TheFirstOfEqualsIsNearestAndTheOtherIsSecond) {
  cv::Mat descriptors = RandomDescriptors(200, 2);
  cv::Mat wanted = RandomDescriptors(1, 3);
  wanted.copyTo(descriptors.row(40));
  wanted.copyTo(descriptors.row(120));
  descriptors.at<uchar>(40, 7) ^= 1;
  descriptors.at<uchar>(120, 9) ^= 4;

  const NearestDescriptor nearest = DescriptorSet(descriptors).FindNearest(wanted.ptr(0));

  EXPECT_EQ(nearest.index, 40);
  EXPECT_EQ(nearest.distance, 1);
  EXPECT_EQ(nearest.second_distance, 1);
}

TEST(DescriptorSet, FindsWhatLookingAtEachFinds) {
  const cv::Mat descriptors = RandomDescriptors(301, 4), wanted = RandomDescriptors(20, 5);
  for (int query = 0; query < wanted.rows; ++query) {
    std::vector<std::pair<int, int>> sorted;
    for (int row = 0; row < descriptors.rows; ++row)
      sorted.emplace_back(HammingDistance(wanted.ptr(query), descriptors.ptr(row)), row);
    std::sort(sorted.begin(), sorted.end());

    const NearestDescriptor nearest = DescriptorSet(descriptors).FindNearest(wanted.ptr(query));

    EXPECT_EQ(nearest.distance, sorted[0].first);
    EXPECT_EQ(nearest.index, sorted[0].second);
    EXPECT_EQ(nearest.second_distance, sorted[1].first);
  }
}

TEST(DescriptorSet, AmongNoneThereIsNone) {
  const cv::Mat wanted = RandomDescriptors(1, 6);
  EXPECT_EQ(DescriptorSet(cv::Mat()).FindNearest(wanted.ptr(0)).index, -1);
}

}  // namespace
}  // namespace parkade
