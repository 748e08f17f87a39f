#pragma once

#include <opencv2/core/types.hpp>
#include <optional>
#include <string_view>

namespace parkade {

/// [px] of the image that an ONNX network asks for: the last two of the four sizes of its first
/// input that has four. Nothing where it leaves them open, or where the bytes are no ONNX.
/// OpenCV 4.6 reads them and does not tell.
std::optional<cv::Size> FindOnnxInputSize(std::string_view model);

}  // namespace parkade
