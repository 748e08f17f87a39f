#pragma once

#include <cstddef>
#include <opencv2/core/mat.hpp>

namespace parkade {

/// Floats in whole lines of the cache (OpenCV's memory is), not initialized.
class FloatBuffer {
 public:
  /// Room for as many, in which nothing of before is kept where it had to grow.
  float* AtLeast(std::size_t count) {
    if (memory_.total() < count) memory_.create(1, static_cast<int>(count), CV_32F);
    return memory_.ptr<float>();
  }

  const float* data() const { return memory_.ptr<float>(); }

 private:
  cv::Mat memory_;
};

}  // namespace parkade
