#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "server/ingest/messages/decoded_image.h"
#include "server/ingest/messages/message_decoding.h"
#include "server/ingest/messages/sensor_stream.h"

namespace parkade {

// None of these functions throws on bad data, and none allocates for an image larger than
// requested. Thread-safe.

// Whether bytes begin as such a file does.
bool IsPng(std::span<const std::uint8_t> data);
bool IsJpeg(std::span<const std::uint8_t> data);

/// Decodes JPEG or PNG, recognized by content. A JPEG is damaged when the codec had to guess
/// anything (see jpeg_decoding.h).
DecodedImage DecodeCompressed(std::span<const std::uint8_t> data, const ImageRequest& request);

/// Decodes mono8, mono16, rgb8, bgr8, rgba8, bgra8, bayer_{rggb,bggr,gbrg,grbg}{8,16}, 8UC1, 8UC3,
/// 16UC1, YUV 4:2:2 and NV12; samples of 10 and 12 bits packed or not, of 14 not.
DecodedImage DecodeRaw(const ImageMessage& message, const ImageRequest& request);

/// Decodes an image of a stream, whatever its type and encoding; but none of a video (see
/// video/encoded_image.h).
DecodedImage DecodeMessageImage(const RawMessage& message, const SensorStream& stream,
                                const ImageRequest& request);

/// Bits in use of samples of 16 bits, rounded up to 8, 10, 12, 14 or 16. Nothing where samples have
/// 8 bits.
std::optional<int> SampleBits(const RawMessage& message, const SensorStream& stream);

}  // namespace parkade
