#include "tests/simulator/render/image_sensor.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace parkade::simulator {
namespace {

cv::Mat Light(float radiance) { return cv::Mat(100, 160, CV_32FC3, cv::Scalar::all(radiance)); }

double MeanOf(const cv::Mat& image) { return cv::mean(image)[1]; }

double NoiseOf(const cv::Mat& image) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(image, mean, deviation);
  return deviation[1];
}

TEST(ImageSensor, FollowsTheLightWithALag) {
  ImageSensor sensor({}, 1);
  const double before = MeanOf(sensor.Develop(Light(0.1f)));
  const double at_once = MeanOf(sensor.Develop(Light(0.03f)));
  double later = 0;
  for (int frame = 0; frame < 60; ++frame) later = MeanOf(sensor.Develop(Light(0.03f)));

  EXPECT_LT(at_once, 0.7 * before);
  EXPECT_NEAR(later, before, 3);
}

TEST(ImageSensor, AmplifiesNoiseInDimLightAndGivesUpInTheDark) {
  ImageSensor bright({}, 1), dim({}, 1), dark({}, 1);
  const cv::Mat in_sun = bright.Develop(Light(0.1f)), at_dusk = dim.Develop(Light(0.01f)),
                under_a_cap = dark.Develop(Light(0.0001f));

  EXPECT_NEAR(MeanOf(at_dusk), MeanOf(in_sun), 4);
  EXPECT_GT(NoiseOf(at_dusk), 2 * NoiseOf(in_sun));
  EXPECT_LT(MeanOf(under_a_cap), 0.4 * MeanOf(in_sun));
}

TEST(ImageSensor, ALongerExposureNeedsLessAmplification) {
  ImageSensor brief({.exposure = 0.003}, 1), patient({.exposure = 0.012}, 1);
  EXPECT_GT(NoiseOf(brief.Develop(Light(0.01f))), 1.5 * NoiseOf(patient.Develop(Light(0.01f))));
}

}  // namespace
}  // namespace parkade::simulator
