#include "slam/places/weighted_blur.h"

#include <opencv2/imgproc.hpp>

namespace parkade {
namespace {

constexpr float kNoWeight = 1e-3F;

cv::Mat BlurBy(const cv::Mat& values, double sigma) {
  cv::Mat blurred;
  cv::GaussianBlur(values, blurred, {}, sigma, sigma, cv::BORDER_CONSTANT);
  return blurred;
}

}  // namespace

cv::Mat MeanAround(const cv::Mat& values, const cv::Mat& weights, double sigma) {
  return MeanAround(values, weights, WeightsAround(weights, sigma), sigma);
}

cv::Mat MeanAround(const cv::Mat& values, const cv::Mat& weights, const cv::Mat& weights_around,
                   double sigma) {
  return BlurBy(values.mul(weights), sigma) / weights_around;
}

cv::Mat WeightsAround(const cv::Mat& weights, double sigma) {
  return BlurBy(weights, sigma) + kNoWeight;
}

}  // namespace parkade
