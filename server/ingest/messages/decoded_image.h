#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>

namespace parkade {

/// The form that an image must have, and the form that is wanted.
struct ImageRequest {
  int width = 0, height = 0;  ///< [px] as calibrated; 0: any size up to 64 megapixels
  bool grayscale = true;      ///< CV_8UC1; false: as recorded (CV_8UC3 BGR where colored)
  int sample_bits = 16;       ///< how many bits of 16-bit samples are in use, see SensorStream
  bool is_intact = false;  ///< known from before: no damage is looked for that the codec forgives
};

/// Why there is no image.
enum class ImageFault {
  kNone,
  kDamaged,
  kWrongSize,
  kWaitsForKeyFrame,  ///< of a video that was not recorded from its beginning
};

/// An image, or what is wrong with it.
struct DecodedImage {
  cv::Mat image;  ///< empty unless the fault is kNone
  ImageFault fault = ImageFault::kNone;
  std::string what;  ///< of the fault, without a full stop
};

/// The fault of an image of this size, or nothing when it may be decoded.
std::optional<DecodedImage> CheckSize(int width, int height, const ImageRequest& request);

}  // namespace parkade
