#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>

#include "tests/simulator/common/fault_options.h"

namespace parkade::simulator {

/// What lies on a lens: mud, which leaves blurred windows of a quarter of the image, or a dark cap,
/// which leaves next to nothing.
class LensCover {
 public:
  /// `kind` is "mud" or "dark"; `size` that of the images.
  LensCover(const std::string& kind, cv::Size size, std::uint64_t seed);

  /// The part of `radiance` (CV_32FC3) that arrives behind the cover.
  void Apply(cv::Mat& radiance) const;

 private:
  cv::Mat transmission_;  ///< CV_32FC1, 0 to 1
  bool is_mud_;           ///< scatters light of its own
};

/// The covers of one camera over the drive.
class CoveredLens {
 public:
  CoveredLens(const FaultOptions& faults, size_t camera, cv::Size size, std::uint64_t seed);

  /// Covers `radiance` as is due at `time` [s of the drive]. The name of the fault that was
  /// applied, or "".
  std::string Apply(cv::Mat& radiance, double time) const;

 private:
  TimeWindow occlusion_, darkness_;
  LensCover cover_, night_;
};

}  // namespace parkade::simulator
