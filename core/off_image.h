#pragma once

namespace parkade {

/// [px] Where a map of cv::remap points that has nothing to show: no neighbor lies in the image,
/// and OpenCV fills in the border's value at once. From -1 on it asks for each neighbor apart,
/// which takes four times as long.
inline constexpr float kOffImage = -10000;

}  // namespace parkade
