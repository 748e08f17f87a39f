#include "slam/places/relative_pose.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"

namespace parkade {

void RelativePoseOptions::Validate() const {
  Require(max_hamming > 0 && max_hamming <= 256 && ratio > 0 && ratio <= 1, ErrorCode::kUsage,
          "max_hamming of relative poses must be 1 to 256 and ratio above 0, at most 1");
  Require(iterations > 0 && max_error > 0 && min_guiding_inliers > 2 && max_tilt_deg > 0 &&
              min_inliers > 2 && min_inliers_of_one > 2 && max_sigma > 0,
          ErrorCode::kUsage,
          "the options of relative poses must be positive, and at least 3 inliers");
  Require(mount_rotation_deg >= 0 && mount_translation >= 0, ErrorCode::kUsage,
          "errors of the mounts must not be negative");
}

nlohmann::json ToJson(const ShownInliers& shown) {
  constexpr double kDigits = 1e4;  // a tenth of a pixel, where an image has a thousand
  nlohmann::json points = nlohmann::json::array();
  for (const MatchedPoint& point : shown.points) {
    nlohmann::json& added = points.emplace_back();
    for (const float share : {point.a.x(), point.a.y(), point.b.x(), point.b.y()})
      added.push_back(std::round(kDigits * static_cast<double>(share)) / kDigits);
  }
  return {{"cameras", {shown.camera_a, shown.camera_b}},
          {"times", {ToDecimalSeconds(shown.image_a), ToDecimalSeconds(shown.image_b)}},
          {"points", points}};
}

}  // namespace parkade
