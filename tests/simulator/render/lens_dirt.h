#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

namespace parkade::simulator {

/// Dust, smears and dried drops on the front of a lens: far out of focus, they take light away
/// softly and scatter what falls on them.
class LensDirt {
 public:
  /// \param dirt  0 to 1, see LensOptions
  /// \param size  of the images
  LensDirt(double dirt, cv::Size size, std::uint64_t seed);

  /// Dims and hazes `radiance` (CV_32FC3) in place; black stays black.
  void Apply(cv::Mat& radiance) const;

 private:
  cv::Mat transmission_;  ///< CV_32FC1, 0 to 1; empty: clean
};

}  // namespace parkade::simulator
