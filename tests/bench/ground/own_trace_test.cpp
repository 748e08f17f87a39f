#include "tests/bench/ground/own_trace.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

GroundTexture TextureOf(const cv::Mat3b& image) {
  GroundTexture texture;
  TextureChart chart;
  chart.image = image;
  chart.mask = cv::Mat(image.size(), CV_8UC1, cv::Scalar(TextureChart::kPainted));
  texture.charts.push_back(std::move(chart));
  return texture;
}

TEST(OwnTrace, AShadowIsFoundWithItsAreaWhateverTheExposure) {
  const cv::Mat3b ground(200, 200, cv::Vec3b(100, 100, 100));
  cv::Mat3b shaded(200, 200, cv::Vec3b(130, 130, 130));
  shaded(cv::Rect(50, 50, 50, 20)).setTo(cv::Scalar(80, 80, 80));
  const OwnTrace trace = FindOwnTrace(TextureOf(shaded), TextureOf(ground));
  EXPECT_NEAR(trace.painted, 16, 1e-9);  // [m2]
  EXPECT_NEAR(trace.dark, 0.4, 0.12);    // its rim is blurred
  EXPECT_EQ(trace.bright, 0);
  EXPECT_EQ(trace.is_visible[0].at<std::uint8_t>(60, 75), 255);
}

TEST(OwnTrace, WhatNoImageShowsDoesNotCount) {
  const GroundTexture ground = TextureOf(cv::Mat3b(100, 100, cv::Vec3b(100, 100, 100)));
  cv::Mat3b image = ground.charts[0].image.clone();
  image.colRange(0, 20).setTo(cv::Scalar(20, 20, 20));
  GroundTexture plain = TextureOf(image);
  plain.charts[0].mask.colRange(0, 20).setTo(TextureChart::kPlain);
  const OwnTrace trace = FindOwnTrace(plain, ground);
  EXPECT_EQ(trace.Share(), 0);
  EXPECT_NEAR(trace.painted, 3.2, 1e-9);
}

}  // namespace
}  // namespace parkade
