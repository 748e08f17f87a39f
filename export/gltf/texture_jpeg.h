#pragma once

#include <cstdint>
#include <vector>

#include "core/ground_texture.h"

namespace parkade {

/// A chart's image as a baseline JPEG, quality 85: photographs of asphalt gain nothing visible
/// above it.
std::vector<std::uint8_t> EncodeTextureJpeg(const TextureChart& chart);

}  // namespace parkade
