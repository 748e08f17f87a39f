#pragma once

#include <string>

#include "server/ingest/pictures/picture_index.h"

namespace parkade {

/// An image as people look at it.
struct Picture {
  std::string jpeg;
  int width = 0, height = 0;            ///< [px] of the JPEG
  int full_width = 0, full_height = 0;  ///< [px] as recorded
};

/// Reads one image of a log, in its colors, as JPEG at most `max_width` pixels wide (0: as
/// recorded); never enlarged. Throws Error{kInvalidInput} with one sentence where it is damaged.
Picture ReadPicture(const MessageSource& source, const IndexedCamera& camera,
                    const IndexedImage& image, int max_width);

}  // namespace parkade
