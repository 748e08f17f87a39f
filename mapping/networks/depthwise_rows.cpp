#include "mapping/networks/depthwise_rows.h"

#include <algorithm>

#include "mapping/networks/vectors.h"

namespace parkade {
namespace {

/// Columns of the output whose windows are on the image in whole.
struct Range {
  int begin, end;
};

template <int kSide>
PARKADE_INLINE Range InnerColumns(const DepthwiseRow& row) {
  if (row.top < 0 || row.top + kSide > row.input.size.height) return {row.width, row.width};
  const int begin = (kSide / 2 + row.stride - 1) / row.stride;
  const int last_left = row.input.size.width - kSide;
  const int end = last_left < 0 ? 0 : (last_left + kSide / 2) / row.stride + 1;
  return {std::min(begin, row.width), std::clamp(end, std::min(begin, row.width), row.width)};
}

/// Any columns: what of windows is on the image.
template <typename Vectors, int kSide>
PARKADE_INLINE void ConvolveBorder(const DepthwiseRow& row, Range columns) {
  const LayerImage& input = row.input;
  for (int column = columns.begin; column < columns.end; ++column) {
    const int left = column * row.stride - kSide / 2;
    const int first = std::max(0, -left), last = std::min(kSide, input.size.width - left);
    const int upper = std::max(0, -row.top), lower = std::min(kSide, input.size.height - row.top);
    for (std::size_t channel = 0; channel < input.step; channel += Vectors::kLength) {
      typename Vectors::Floats sum = Vectors::At(row.finish.bias + channel).values;
      for (int i = upper; i < lower; ++i)
        for (int j = first; j < last; ++j)
          sum += Vectors::At(input.At(row.top + i, left + j) + channel).values *
                 Vectors::At(row.weights + static_cast<std::size_t>(i * kSide + j) * input.step +
                             channel)
                     .values;
      StoreFinished<Vectors>(row.finish, sum,
                             static_cast<std::size_t>(column) * input.step + channel, row.output);
    }
  }
}

template <typename Vectors, int kSide>
PARKADE_INLINE void ConvolveInner(const DepthwiseRow& row, Range columns) {
  const LayerImage& input = row.input;
  const std::size_t row_step = static_cast<std::size_t>(input.size.width) * input.step;
  for (std::size_t channel = 0; channel < input.step; channel += Vectors::kLength) {
    typename Vectors::Floats weights[kSide * kSide];
#pragma GCC unroll 25
    for (std::size_t k = 0; k < kSide * kSide; ++k)
      weights[k] = Vectors::At(row.weights + k * input.step + channel).values;
    const typename Vectors::Floats bias = Vectors::At(row.finish.bias + channel).values;
    for (int column = columns.begin; column < columns.end; ++column) {
      const float* from = input.At(row.top, column * row.stride - kSide / 2) + channel;
      typename Vectors::Floats sums[2] = {bias, {}};
#pragma GCC unroll 5
      for (std::size_t i = 0; i < kSide; ++i)
#pragma GCC unroll 5
        for (std::size_t j = 0; j < kSide; ++j)
          sums[(i * kSide + j) % 2] +=
              Vectors::At(from + i * row_step + j * input.step).values * weights[i * kSide + j];
      sums[0] += sums[1];
      StoreFinished<Vectors>(row.finish, sums[0],
                             static_cast<std::size_t>(column) * input.step + channel, row.output);
    }
  }
}

template <typename Vectors, int kSide>
PARKADE_INLINE void ConvolveDepthwise(const DepthwiseRow& row) {
  const Range inner = InnerColumns<kSide>(row);
  ConvolveBorder<Vectors, kSide>(row, {0, inner.begin});
  ConvolveInner<Vectors, kSide>(row, inner);
  ConvolveBorder<Vectors, kSide>(row, {inner.end, row.width});
}

}  // namespace

void ConvolveDepthwise3(const DepthwiseRow& row) {
  RunInVectors([&](auto vectors)
                   PARKADE_INLINE_CALL { ConvolveDepthwise<decltype(vectors), 3>(row); });
}

void ConvolveDepthwise5(const DepthwiseRow& row) {
  RunInVectors([&](auto vectors)
                   PARKADE_INLINE_CALL { ConvolveDepthwise<decltype(vectors), 5>(row); });
}

}  // namespace parkade
