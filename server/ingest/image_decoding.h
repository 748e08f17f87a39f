#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <string>

#include "server/ingest/message_decoding.h"
#include "server/ingest/sensor_stream.h"

namespace parkade {

/// What an image must be, and how it is wanted.
struct ImageRequest {
  int width = 0, height = 0;  ///< [px] as calibrated; 0: any size up to 64 megapixels
  bool grayscale = true;      ///< CV_8UC1; false: as recorded (CV_8UC3 BGR where coloured)
  int sample_bits = 16;       ///< of samples of 16 bits: how many are in use, see SensorStream
};

enum class ImageFault { kNone, kDamaged, kWrongSize };

struct DecodedImage {
  cv::Mat image;  ///< empty unless the fault is kNone
  ImageFault fault = ImageFault::kNone;
  std::string what;  ///< of the fault, without a full stop
};

/// The fault of an image of this size, or nothing when it may be decoded.
std::optional<DecodedImage> CheckSize(int width, int height, const ImageRequest& request);

// None of these throws on bad data, and none allocates for an image larger than requested. Thread-safe.

/// JPEG or PNG, recognised by content. A JPEG is damaged when the codec had to guess anything (see jpeg_decoding.h).
DecodedImage DecodeCompressed(std::span<const std::uint8_t> data, const ImageRequest& request);

/// mono8, mono16, rgb8, bgr8, rgba8, bgra8, bayer_{rggb,bggr,gbrg,grbg}{8,16}, 8UC1, 8UC3, 16UC1.
DecodedImage DecodeRaw(const ImageMessage& message, const ImageRequest& request);

/// An image of a stream, whatever its type and encoding.
DecodedImage DecodeMessageImage(const RawMessage& message, const SensorStream& stream, const ImageRequest& request);

/// Bits in use of samples of 16 bits, rounded up to 8, 10, 12, 14 or 16. Nothing where samples have 8 bits.
std::optional<int> SampleBits(const RawMessage& message, const SensorStream& stream);

}  // namespace parkade
