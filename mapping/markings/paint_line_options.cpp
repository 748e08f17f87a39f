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
}

}  // namespace parkade
