#include "slam/places/weighted_blur.h"

#include <opencv2/imgproc.hpp>

namespace parkade {
namespace {

constexpr float kNoWeight = 1e-3F;

}  // namespace

cv::Mat MeanAround(const cv::Mat& values, const cv::Mat& weights, double sigma) {
  cv::Mat sum, weight;
  cv::GaussianBlur(values.mul(weights), sum, {}, sigma, sigma, cv::BORDER_CONSTANT);
  cv::GaussianBlur(weights, weight, {}, sigma, sigma, cv::BORDER_CONSTANT);
  return sum / (weight + kNoWeight);
}

}  // namespace parkade
