#pragma once

#include <algorithm>
#include <random>
#include <vector>

#include "mapping/networks/layer.h"
#include "mapping/networks/vectors.h"

namespace parkade {

/// Between -1 and 1.
inline std::vector<float> RandomFloats(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<float> floats(static_cast<size_t>(count));
  for (float& value : floats) value = static_cast<float>(random() % 2001) / 1000 - 1;
  return floats;
}

/// A layer's answer to random numbers.
struct LayerRun {
  LayerRun(const Layer& layer, const cv::Size& size, int channels, bool is_something_added)
      : input(MakeImage(size, channels, layer.TakesAnyStep(), input_memory)),
        output(MakeImage(layer.OutputSize(size), layer.OutputChannels(channels), false, memory)) {
    if (is_something_added) added = RandomImage(output, 4);
    const std::vector<float> values = RandomImage(input, 3);
    std::copy(values.begin(), values.end(), input.data);
    layer.Run(input, is_something_added ? added.data() : nullptr, output, scratch);
  }

  double AddedAt(int row, int column, int channel) const {
    return added.empty() ? 0
                         : static_cast<double>(
                               added[static_cast<size_t>(output.At(row, column) - output.data) +
                                     static_cast<size_t>(channel)]);
  }

  FloatBuffer input_memory, memory, scratch;
  LayerImage input, output;
  std::vector<float> added;

 private:
  static LayerImage MakeImage(const cv::Size& size, int channels, bool is_dense,
                              FloatBuffer& memory) {
    const auto step = static_cast<size_t>(channels);
    LayerImage image{size, channels, is_dense ? step : RoundUpToGroup(step), nullptr};
    image.data = memory.AtLeast(image.num_pixels() * image.step);
    return image;
  }

  /// Zeros behind the channels.
  static std::vector<float> RandomImage(const LayerImage& image, unsigned seed) {
    std::vector<float> values =
        RandomFloats(static_cast<int>(image.num_pixels() * image.step), seed);
    for (size_t i = 0; i < values.size(); ++i)
      if (i % image.step >= static_cast<size_t>(image.channels)) values[i] = 0;
    return values;
  }
};

}  // namespace parkade
