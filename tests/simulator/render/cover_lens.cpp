#include "tests/simulator/render/cover_lens.h"

namespace parkade::simulator {

void CoverLens(const cv::Mat& transmission, const cv::Vec3f& glow, cv::Mat& radiance) {
  for (int row = 0; row < radiance.rows; ++row) {
    for (int column = 0; column < radiance.cols; ++column) {
      cv::Vec3f& light = radiance.at<cv::Vec3f>(row, column);
      if (light == cv::Vec3f::zeros()) continue;
      const float through = transmission.at<float>(row, column);
      light = through * light + (1 - through) * glow;
    }
  }
}

}  // namespace parkade::simulator
