#include "mapping/evaluation/surface_picture.h"

#include <algorithm>
#include <climits>

namespace parkade {
namespace {

const cv::Vec3b kNothing(255, 255, 255), kBoth(215, 215, 215), kBothRims(165, 165, 165),
    kOneRim(90, 170, 250), kFalse(40, 40, 220), kMissed(220, 110, 30);

struct Bounds {
  int left = INT_MAX, right = INT_MIN, bottom = INT_MAX, top = INT_MIN;

  void Include(const ScopedRaster& scoped) {
    for (size_t i = 0; i < scoped.samples().size(); ++i) {
      if (!scoped.counts[i]) continue;
      const HeightRaster::Sample& sample = scoped.samples()[i];
      left = std::min(left, sample.x);
      right = std::max(right, sample.x);
      bottom = std::min(bottom, sample.y);
      top = std::max(top, sample.y);
    }
  }
};

}  // namespace

cv::Mat PaintSurfaceErrors(const ScopedSurfaces& surfaces, double rim_width,
                           const SurfaceEvaluationOptions& options) {
  const ScopedRaster &truth = surfaces.truth, &estimate = surfaces.estimate;
  Bounds bounds;
  bounds.Include(truth);
  bounds.Include(estimate);
  if (bounds.right < bounds.left) return {1, 1, CV_8UC3, cv::Scalar::all(255)};
  cv::Mat picture(bounds.top - bounds.bottom + 1, bounds.right - bounds.left + 1, CV_8UC3,
                  cv::Scalar::all(kNothing[0]));
  const auto pixel = [&](const HeightRaster::Sample& sample) -> cv::Vec3b& {
    return picture.at<cv::Vec3b>(bounds.top - sample.y, sample.x - bounds.left);
  };
  const Rims rims = FindRims(surfaces, rim_width, options);
  // Samples lie in order of their heights: the uppermost is painted last.
  for (size_t i = 0; i < truth.samples().size(); ++i)
    if (truth.counts[i]) pixel(truth.samples()[i]) = kMissed;
  for (size_t i = 0; i < estimate.samples().size(); ++i) {
    if (!estimate.counts[i]) continue;
    const HeightRaster::Sample& sample = estimate.samples()[i];
    const int found = truth.Find(sample, options.max_height_gap);
    const bool is_rim = rims.of_estimate[i];
    const bool is_true_rim = found >= 0 && rims.of_truth[static_cast<size_t>(found)];
    pixel(sample) = found < 0               ? kFalse
                    : is_rim != is_true_rim ? kOneRim
                    : is_rim                ? kBothRims
                                            : kBoth;
  }
  return picture;
}

}  // namespace parkade
