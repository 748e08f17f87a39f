#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace parkade {

/// ONNX with one convolution of size 1 over three channels: output channel k is the image times
/// `weights[3 k .. 3 k + 2]` plus `biases[k]`. `width` and `height` are the input's; 0 leaves them
/// open.
std::string TinyOnnx(const std::vector<float>& weights, const std::vector<float>& biases, int width,
                     int height);

}  // namespace parkade
