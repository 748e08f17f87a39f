#include "export/gltf/texture_jpeg.h"

#include <opencv2/imgcodecs.hpp>

#include "core/error.h"

namespace parkade {

std::vector<std::uint8_t> EncodeTextureJpeg(const TextureChart& chart) {
  constexpr int kQuality = 85;
  std::vector<std::uint8_t> bytes;
  Require(cv::imencode(".jpg", chart.image, bytes, {cv::IMWRITE_JPEG_QUALITY, kQuality}),
          ErrorCode::kInternal, "OpenCV could not write a texture");
  return bytes;
}

}  // namespace parkade
