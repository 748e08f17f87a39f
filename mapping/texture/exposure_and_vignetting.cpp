#include "mapping/texture/exposure_and_vignetting.h"

namespace parkade {

ExposureAndVignetting::ExposureAndVignetting(const Eigen::Array3f& gain, const Falloff& falloff,
                                             int width, int height)
    : middle_(0.5F * static_cast<float>(width - 1), 0.5F * static_cast<float>(height - 1)),
      steps_per_square_(static_cast<float>(kNumSteps - 1) / middle_.squaredNorm()) {
  for (std::size_t i = 0; i < kNumSteps; ++i) {
    const float square = static_cast<float>(i) / static_cast<float>(kNumSteps - 1);
    const Eigen::Array3f factor = gain * (square * falloff[0] + square * square * falloff[1]).exp();
    factors_[i] = {factor[0], factor[1], factor[2]};
  }
}

}  // namespace parkade
