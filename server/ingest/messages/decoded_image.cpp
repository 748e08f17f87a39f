#include "server/ingest/messages/decoded_image.h"

#include <cstdint>

namespace parkade {
namespace {

constexpr std::int64_t kMaxPixels = std::int64_t{64} << 20;

}  // namespace

std::optional<DecodedImage> CheckSize(int width, int height, const ImageRequest& request) {
  const std::string size = std::to_string(width) + "x" + std::to_string(height);
  const bool is_any = request.width == 0;
  if (is_any && std::int64_t{width} * height <= kMaxPixels) return std::nullopt;
  if (!is_any && width == request.width && height == request.height) return std::nullopt;
  return DecodedImage{{},
                      ImageFault::kWrongSize,
                      is_any ? "the image is " + size + " pixels, more than Parkade takes"
                             : "the image is " + size + ", calibrated is " +
                                   std::to_string(request.width) + "x" +
                                   std::to_string(request.height)};
}

}  // namespace parkade
