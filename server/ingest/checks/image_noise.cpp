#include "server/ingest/checks/image_noise.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace parkade {

double ImageNoise(const cv::Mat& image) {
  constexpr int kSquare = 16;                      // [px]
  constexpr float kDarkest = 30, kLightest = 225;  // beyond, noise is cut off
  constexpr int kMinSquares = 40;
  const cv::Size squares(image.cols / kSquare, image.rows / kSquare);
  if (squares.area() < kMinSquares) return 0;
  const cv::Mat part = image(cv::Rect({}, squares * kSquare));
  // The difference of two Laplacians: blind to slopes and curvature, it sums 36 variances.
  const cv::Matx33f kernel(1, -2, 1, -2, 4, -2, 1, -2, 1);
  cv::Mat differences, roughness, brightness;
  cv::filter2D(part, differences, CV_32F, kernel, {-1, -1}, 0, cv::BORDER_REFLECT_101);
  cv::resize(cv::abs(differences), roughness, squares, 0, 0, cv::INTER_AREA);
  cv::resize(part, brightness, squares, 0, 0, cv::INTER_AREA);
  std::vector<float> values;
  for (int y = 0; y < squares.height; ++y)
    for (int x = 0; x < squares.width; ++x)
      if (const auto level = brightness.at<unsigned char>(y, x);
          level >= kDarkest && level <= kLightest)
        values.push_back(roughness.at<float>(y, x));
  if (values.empty()) return 0;
  const auto quarter = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 4);
  std::nth_element(values.begin(), quarter, values.end());
  return std::sqrt(M_PI / 2) / 6 * *quarter;
}

}  // namespace parkade
