#include "slam/smoother/smoother_options.h"

#include "core/error.h"

namespace parkade {

void SmootherOptions::Validate() const {
  Require(window_nodes >= 4 && window_nodes <= 100, ErrorCode::kUsage,
          "'window_nodes' must be in 4..100");
  Require(landmarks >= 10 && landmarks <= 2000, ErrorCode::kUsage,
          "'landmarks' must be in 10..2000");
  Require(max_iterations >= 1, ErrorCode::kUsage, "iterations must be positive");
  calibration.Validate();
}

void CalibrationOptions::Validate() const {
  Require(rotation_deg > 0 && translation_share > 0 && translation >= 1e-3 &&
              time_offset_sigma > 0 && line_delay_share > 0,
          ErrorCode::kUsage,
          "sigmas of the calibration must be positive, and that of translation at least 1 mm");
}

}  // namespace parkade
