#include "mapping/networks/layered_network.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/error.h"
#include "mapping/networks/vectors.h"

namespace parkade {
namespace {

/// Room in a buffer for an image; pixels of `step` floats.
LayerImage MakeImage(const cv::Size& size, int channels, std::size_t step, FloatBuffer& buffer) {
  LayerImage image{.size = size, .channels = channels, .step = step, .data = nullptr};
  image.data = buffer.AtLeast(image.num_pixels() * step);
  return image;
}

/// From plane after plane to pixel after pixel.
void FillImage(const cv::Mat& planes, float factor, const LayerImage& image) {
  const int channels = image.channels, width = image.size.width;
  if (image.step > static_cast<std::size_t>(channels))
    std::fill_n(image.data, image.num_pixels() * image.step, 0.0F);
  for (int row = 0; row < image.size.height; ++row)
    for (int channel = 0; channel < channels; ++channel) {
      const float* from = planes.ptr<float>(0, channel) + row * width;
      float* to = image.At(row, 0) + channel;
      for (int column = 0; column < width; ++column, to += image.step) *to = factor * from[column];
    }
}

cv::Mat PlanesOf(const LayerImage& image) {
  const std::array<int, 4> sizes{1, image.channels, image.size.height, image.size.width};
  cv::Mat planes(4, sizes.data(), CV_32F);
  for (int row = 0; row < image.size.height; ++row)
    for (int channel = 0; channel < image.channels; ++channel) {
      float* to = planes.ptr<float>(0, channel) + row * image.size.width;
      const float* from = image.At(row, 0) + channel;
      for (int column = 0; column < image.size.width; ++column, from += image.step)
        to[column] = *from;
    }
  return planes;
}

}  // namespace

std::optional<LayeredNetwork> LayeredNetwork::Read(std::string_view model) {
  const std::optional<OnnxGraph> graph = ReadOnnxGraph(model);
  if (!graph) return std::nullopt;
  std::optional<LayerPlan> plan = PlanLayers(*graph);
  if (!plan) return std::nullopt;
  return LayeredNetwork(std::move(*plan));
}

cv::Mat LayeredNetwork::Run(const cv::Mat& input, Buffers& buffers) const {
  Require(input.dims == 4 && input.type() == CV_32F && input.isContinuous() && input.size[0] == 1 &&
              input.size[1] == plan_.input_channels && input.total() > 0,
          ErrorCode::kInvalidInput, "the network takes images of other channels");
  buffers.images.resize(static_cast<std::size_t>(plan_.num_buffers));
  std::vector<LayerImage> images(buffers.images.size());
  const auto channels = static_cast<std::size_t>(plan_.input_channels);
  images[0] =
      MakeImage({input.size[3], input.size[2]}, plan_.input_channels,
                plan_.is_input_dense ? channels : RoundUpToGroup(channels), buffers.images[0]);
  FillImage(input, plan_.input_factor, images[0]);
  for (const LayerStep& step : plan_.steps) {
    const LayerImage& from = images[static_cast<std::size_t>(step.input)];
    const auto output = static_cast<std::size_t>(step.output);
    const int num_outputs = step.layer->OutputChannels(from.channels);
    const LayerImage to =
        MakeImage(step.layer->OutputSize(from.size), num_outputs,
                  RoundUpToGroup(static_cast<std::size_t>(num_outputs)), buffers.images[output]);
    const LayerImage* added =
        step.added < 0 ? nullptr : &images[static_cast<std::size_t>(step.added)];
    Require(added == nullptr || added->size == to.size, ErrorCode::kInvalidInput,
            "the network takes images of other sizes");
    step.layer->Run(from, added == nullptr ? nullptr : added->data, to, buffers.scratch);
    images[output] = to;
  }
  return PlanesOf(images[static_cast<std::size_t>(plan_.steps.back().output)]);
}

}  // namespace parkade
