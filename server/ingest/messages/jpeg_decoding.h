#pragma once

#include <cstdint>
#include <span>

#include "server/ingest/messages/decoded_image.h"

namespace parkade {

/// Decodes a JPEG with libjpeg-turbo. A file counts as damaged when the codec warns, other
/// than of stray bytes, or FindJpegDamage finds something (jpeg_check.h); OpenCV returns an image
/// for nearly all of these. The latter, which takes as long as decoding in gray, is left out where
/// the image is known to be intact. Grayscale takes the luma alone and skips chroma.
DecodedImage DecodeJpeg(std::span<const std::uint8_t> data, const ImageRequest& request);

}  // namespace parkade
