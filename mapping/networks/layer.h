#pragma once

#include <cstddef>
#include <opencv2/core/types.hpp>

#include "mapping/networks/float_buffer.h"

namespace parkade {

/// What layers read and write: pixel after pixel, row after row, the channels of each together.
struct LayerImage {
  cv::Size size;         ///< [px]
  int channels = 0;      ///< that mean something
  std::size_t step = 0;  ///< floats from pixel to pixel; what is behind the channels is zero
  float* data = nullptr;

  float* At(int row, int column) const {
    return data + static_cast<std::size_t>(row * size.width + column) * step;
  }
  std::size_t num_pixels() const { return static_cast<std::size_t>(size.area()); }
};

/// One step of a network; immutable, thread-safe.
class Layer {
 public:
  Layer() = default;
  virtual ~Layer() = default;
  Layer(const Layer&) = delete;
  Layer& operator=(const Layer&) = delete;

  virtual cv::Size OutputSize(const cv::Size& input) const { return input; }
  virtual int OutputChannels(int input) const { return input; }

  /// Whether pixels may lie closer than in whole groups.
  virtual bool TakesAnyStep() const { return false; }

  /// \param added    as large as the output, to be added to it; none where null
  /// \param scratch  of the caller's thread
  virtual void Run(const LayerImage& input, const float* added, const LayerImage& output,
                   FloatBuffer& scratch) const = 0;
};

}  // namespace parkade
