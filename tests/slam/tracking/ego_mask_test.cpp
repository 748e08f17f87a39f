#include "slam/tracking/ego_mask.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

TEST(EgoMask, WhatStaysStillWhileTurningIsTheCar) {
  EgoMask map(320, 200);
  const Eigen::Vector2d bonnet(100, 180), wall(100, 50), turn(4, 0);

  for (int i = 0; i < 20; ++i) {
    map.Add(bonnet, bonnet + Eigen::Vector2d(0.05, 0), bonnet + turn);
    map.Add(wall, wall + turn, wall + turn);
  }

  EXPECT_TRUE(map.IsEgoVehicle(bonnet));
  EXPECT_FALSE(map.IsEgoVehicle(wall));
  const cv::Mat usable = map.Exclude(cv::Mat(200, 320, CV_8UC1, cv::Scalar(255)));
  EXPECT_EQ(usable.at<std::uint8_t>(180, 100), 0);
  EXPECT_EQ(usable.at<std::uint8_t>(50, 100), 255);
}

TEST(EgoMask, FarPointsOnAStraightRoadAreNotTheCar) {
  EgoMask map(320, 200);
  const Eigen::Vector2d horizon(160, 100);

  for (int i = 0; i < 1000; ++i) map.Add(horizon, horizon, horizon + Eigen::Vector2d(0.3, 0));

  EXPECT_FALSE(map.IsEgoVehicle(horizon));
}

TEST(EgoMask, ACarAheadThatIsSometimesElsewhereIsForgiven) {
  EgoMask map(320, 200);
  const Eigen::Vector2d ahead(160, 90), turn(4, 0);
  for (int i = 0; i < 10; ++i) map.Add(ahead, ahead, ahead + turn);
  ASSERT_TRUE(map.IsEgoVehicle(ahead));
  const int version = map.version();

  for (int i = 0; i < 10; ++i) map.Add(ahead, ahead + turn, ahead + turn);

  EXPECT_FALSE(map.IsEgoVehicle(ahead));
  EXPECT_GT(map.version(), version);
}

TEST(EgoMask, PixelsOutsideTheImageAreIgnored) {
  EgoMask map(320, 200);
  for (const Eigen::Vector2d& pixel :
       {Eigen::Vector2d(-5, 10), Eigen::Vector2d(400, 10), Eigen::Vector2d(10, 1e9)}) {
    map.Add(pixel, pixel, pixel + Eigen::Vector2d(5, 0));
    EXPECT_FALSE(map.IsEgoVehicle(pixel));
  }
}

}  // namespace
}  // namespace parkade
