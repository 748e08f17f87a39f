#include "mapping/markings/paint_line_options.h"

#include "core/error.h"

namespace parkade {

void PaintLineOptions::Validate() const {
  Require(pixel_size > 0 && pixel_size <= 0.1, ErrorCode::kUsage,
          "pixel_size of lines must be in 0..0.1 m");
  Require(stripe_width >= 2 * pixel_size, ErrorCode::kUsage,
          "stripe_width must be at least two pixels");
  Require(filter_length > stripe_width, ErrorCode::kUsage,
          "filter_length must exceed stripe_width");
  Require(min_contrast > 0, ErrorCode::kUsage, "min_contrast must be > 0");
  Require(min_length > 0 && max_gap >= 0, ErrorCode::kUsage,
          "min_length must be > 0 m and max_gap not negative");
  Require(max_directions > 0, ErrorCode::kUsage, "max_directions must be > 0");
}

}  // namespace parkade
