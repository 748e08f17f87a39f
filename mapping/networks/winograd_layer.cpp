#include <algorithm>
#include <array>
#include <cstring>

#include "mapping/networks/convolution.h"
#include "mapping/networks/matrix_product.h"
#include "mapping/networks/winograd_transforms.h"

namespace parkade {
namespace {

constexpr std::size_t kFloatsAtATime = 160 << 10;  // of planes: they stay in a core's own cache
constexpr std::size_t kLine = 16;                  // floats of a line of the cache

/// G g G^T of the weights from one channel to one other: element `plane`.
float TransformedWeight(const Convolution& convolution, int output, int input, int plane) {
  static constexpr std::array<std::array<double, 3>, kWinogradPatch> kG{
      {{1.0 / 4, 0, 0},
       {-1.0 / 6, -1.0 / 6, -1.0 / 6},
       {-1.0 / 6, 1.0 / 6, -1.0 / 6},
       {1.0 / 24, 1.0 / 12, 1.0 / 6},
       {1.0 / 24, -1.0 / 12, 1.0 / 6},
       {0, 0, 1}}};
  const auto& of_row = kG[static_cast<std::size_t>(plane / kWinogradPatch)];
  const auto& of_column = kG[static_cast<std::size_t>(plane % kWinogradPatch)];
  double sum = 0;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      sum += of_row[static_cast<std::size_t>(row)] * of_column[static_cast<std::size_t>(column)] *
             static_cast<double>(convolution.WeightAt(output, input, row, column));
  return static_cast<float>(sum);
}

int NumTiles(int length) { return (length + kWinogradTile - 1) / kWinogradTile; }

/// Planes of patches and of their products, for some rows of tiles.
struct Planes {
  Planes(const LayerImage& input, const LayerImage& output, FloatBuffer& scratch) {
    const auto across = static_cast<std::size_t>(NumTiles(output.size.width));
    const std::size_t of_row = kWinogradPlanes * across * (input.step + output.step);
    rows = static_cast<int>(std::clamp<std::size_t>(
        kFloatsAtATime / of_row, 1, static_cast<std::size_t>(NumTiles(output.size.height))));
    // An odd number of lines: planes would otherwise be at odds for the same ones of the cache.
    const auto step = [&](std::size_t channels) {
      const std::size_t lines = (static_cast<std::size_t>(rows) * across * channels) / kLine + 1;
      return (lines | 1U) * kLine;
    };
    patch_step = step(input.step);
    sum_step = step(output.step);
    border = scratch.AtLeast(kWinogradPlanes * (input.step + patch_step + sum_step));
    patches = border + kWinogradPlanes * input.step;
    sums = patches + kWinogradPlanes * patch_step;
  }

  int rows;                          // of tiles at a time
  std::size_t patch_step, sum_step;  // floats from plane to plane
  float* border;                     // a patch that is partly off the image
  float* patches;
  float* sums;
};

class WinogradLayer : public Layer {
 public:
  explicit WinogradLayer(const Convolution& convolution)
      : outputs_(convolution.outputs),
        is_rectified_(convolution.is_rectified),
        bias_(PaddedBias(convolution)) {
    for (int plane = 0; plane < static_cast<int>(kWinogradPlanes); ++plane)
      weights_.emplace_back(convolution.inputs, convolution.outputs, [&](int input, int output) {
        return TransformedWeight(convolution, output, input, plane);
      });
  }

  int OutputChannels(int) const override { return outputs_; }

  void Run(const LayerImage& input, const float* added, const LayerImage& output,
           FloatBuffer& scratch) const override {
    const Planes planes(input, output, scratch);
    const int across = NumTiles(output.size.width), down = NumTiles(output.size.height);
    for (int top = 0; top < down; top += planes.rows) {
      const int bottom = std::min(top + planes.rows, down);
      const auto num_tiles = static_cast<std::size_t>((bottom - top) * across);
      std::size_t tile = 0;
      for (int row = top; row < bottom; ++row)
        for (int column = 0; column < across; ++column, ++tile)
          TakePatch(input, {column, row}, planes, tile);
      for (std::size_t plane = 0; plane < kWinogradPlanes; ++plane)
        Multiply({planes.patches + plane * planes.patch_step, input.step, num_tiles},
                 weights_[plane], {}, planes.sums + plane * planes.sum_step);
      tile = 0;
      for (int row = top; row < bottom; ++row)
        for (int column = 0; column < across; ++column, ++tile)
          GiveTile(planes, tile, added, output, {column, row});
    }
  }

 private:
  static void TakePatch(const LayerImage& input, const cv::Point& place, const Planes& planes,
                        std::size_t tile) {
    const cv::Rect patch(cv::Point(place.x * kWinogradTile - 1, place.y * kWinogradTile - 1),
                         cv::Size(kWinogradPatch, kWinogradPatch));
    const cv::Rect on_image = patch & cv::Rect({}, input.size);
    float* to = planes.patches + tile * input.step;
    if (on_image == patch) {
      const std::size_t row_step = static_cast<std::size_t>(input.size.width) * input.step;
      TransformPatch(input.At(patch.y, patch.x), {input.step, row_step}, to, planes.patch_step);
      return;
    }
    const std::size_t row_step = kWinogradPatch * input.step;
    std::fill_n(planes.border, kWinogradPatch * row_step, 0.0F);
    for (int row = on_image.y; row < on_image.br().y; ++row)
      std::copy_n(input.At(row, on_image.x), static_cast<std::size_t>(on_image.width) * input.step,
                  planes.border + static_cast<std::size_t>(row - patch.y) * row_step +
                      static_cast<std::size_t>(on_image.x - patch.x) * input.step);
    TransformPatch(planes.border, {input.step, row_step}, to, planes.patch_step);
  }

  void GiveTile(const Planes& planes, std::size_t tile, const float* added,
                const LayerImage& output, const cv::Point& place) const {
    const int row = place.y * kWinogradTile, column = place.x * kWinogradTile;
    float* to = output.At(row, column);
    const float* added_here = added == nullptr ? nullptr : added + (to - output.data);
    TransformSums(
        planes.sums + tile * output.step, planes.sum_step,
        {.data = to,
         .steps = {output.step, static_cast<std::size_t>(output.size.width) * output.step},
         .rows = std::min(kWinogradTile, output.size.height - row),
         .columns = std::min(kWinogradTile, output.size.width - column),
         .finish = {bias_.data(), is_rectified_, added_here}});
  }

  int outputs_;
  bool is_rectified_;
  std::vector<float> bias_;
  std::vector<PackedMatrix> weights_;  // of each plane
};

}  // namespace

std::unique_ptr<Layer> MakeWinogradLayer(const Convolution& convolution) {
  return std::make_unique<WinogradLayer>(convolution);
}

}  // namespace parkade
