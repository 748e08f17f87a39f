#include "tests/simulator/render/lens_cover.h"

#include "tests/simulator/common/noise.h"
#include "tests/simulator/common/random.h"
#include "tests/simulator/render/cover_lens.h"

namespace parkade::simulator {

LensCover::LensCover(const std::string& kind, cv::Size size, std::uint64_t seed)
    : is_mud_(kind == "mud") {
  constexpr float kDark = 0.001f, kThroughMud = 0.03f,
                  kBlots = 5;  // shares of light; across the image
  transmission_.create(size, CV_32FC1);
  const std::uint32_t noise_seed = static_cast<std::uint32_t>(Mix64(seed));
  for (int row = 0; row < size.height; ++row) {
    for (int column = 0; column < size.width; ++column) {
      const float scale = kBlots / static_cast<float>(size.width);
      const float noise = FractalNoise(scale * static_cast<float>(column),
                                       scale * static_cast<float>(row), 4, noise_seed);
      const float window = SmoothStep(0.08f, 0.45f, noise);
      transmission_.at<float>(row, column) =
          is_mud_ ? kThroughMud + (1 - kThroughMud) * window : kDark;
    }
  }
}

void LensCover::Apply(cv::Mat& radiance) const {
  const cv::Vec3f mud(0.5f, 0.42f, 0.33f);
  const cv::Scalar mean = cv::mean(radiance);
  const float glow = is_mud_ ? 0.25f * static_cast<float>(mean[1]) : 0;
  CoverLens(transmission_, glow * mud, radiance);
}

CoveredLens::CoveredLens(const FaultOptions& faults, size_t camera, cv::Size size,
                         std::uint64_t seed)
    : darkness_(faults.darkness),
      cover_(faults.occlusion.kind, size, Mix64(seed) + camera),
      night_("dark", size, seed) {
  if (static_cast<size_t>(faults.occlusion.camera) == camera)
    occlusion_ = {faults.occlusion.begin, faults.occlusion.end};
}

std::string CoveredLens::Apply(cv::Mat& radiance, double time) const {
  if (darkness_.Contains(time)) {
    night_.Apply(radiance);
    return "darkness";
  }
  if (!occlusion_.Contains(time)) return "";
  cover_.Apply(radiance);
  return "occlusion";
}

}  // namespace parkade::simulator
