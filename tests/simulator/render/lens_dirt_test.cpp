#include "tests/simulator/render/lens_dirt.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace parkade::simulator {
namespace {

const cv::Size kSize(320, 200);

cv::Mat Behind(double dirt, float light) {
  cv::Mat radiance(kSize, CV_32FC3, cv::Scalar::all(light));
  LensDirt(dirt, kSize, 4).Apply(radiance);
  return radiance;
}

TEST(LensDirt, TakesLightFromPartOfTheImageAlone) {
  const cv::Mat spoiled = Behind(1, 1);
  cv::Mat green;
  cv::extractChannel(spoiled, green, 1);
  const double total = static_cast<double>(green.total()),
               dimmed = cv::countNonZero(green < 0.95) / total,
               dark = cv::countNonZero(green < 0.7) / total;
  EXPECT_GT(dimmed, 0.1);
  EXPECT_LT(dimmed, 0.6);
  EXPECT_GT(dark, 0.0005);
  EXPECT_LT(dark, 0.05);
}

TEST(LensDirt, LeavesAloneWhatIsCleanOrBlack) {
  EXPECT_EQ(cv::norm(Behind(0, 0.4f), cv::Mat(kSize, CV_32FC3, cv::Scalar::all(0.4f))), 0);
  EXPECT_EQ(cv::norm(Behind(1, 0)), 0);
}

TEST(LensDirt, HazesWhatIsDarkerThanTheRest) {
  cv::Mat radiance(kSize, CV_32FC3, cv::Scalar::all(1));
  cv::Mat half = radiance.colRange(0, kSize.width / 2);
  half.setTo(cv::Scalar::all(0.01));
  LensDirt(1, kSize, 4).Apply(radiance);
  EXPECT_GT(cv::mean(half)[1], 0.012);
}

}  // namespace
}  // namespace parkade::simulator
