#include "mapping/networks/matrix_product.h"

#include <algorithm>

#include "mapping/networks/vectors.h"

namespace parkade {
namespace {

constexpr std::size_t kPanel = 3;  // groups

/// Rows of a tile: with a panel's columns, sums and factors fill 16 registers.
template <typename Vectors>
constexpr std::size_t kTileRows = Vectors::kLength / 2;

/// A tile of the product: what is read and written of it.
struct Tile {
  MatrixRows rows;
  const float* panel;
  std::size_t part_length;
  LayerFinish finish;
  float* product;
  std::size_t product_step;
};

template <typename Vectors, std::size_t kRows, std::size_t kNumGroups>
PARKADE_INLINE void MultiplyTile(const Tile& tile) {
  constexpr std::size_t kLength = Vectors::kLength, kAcross = kNumGroups * kGroup / kLength;
  typename Vectors::Floats sums[kRows][kAcross] = {};
  if (tile.finish.bias != nullptr)
    for (auto& row : sums)
      for (std::size_t i = 0; i < kAcross; ++i)
        row[i] = Vectors::At(tile.finish.bias + i * kLength).values;
  const float* factors = tile.panel;
  for (std::size_t part = 0; part < tile.rows.num_parts; ++part) {
    const float* rows = tile.rows.data + part * tile.rows.part_step;
    for (std::size_t k = 0; k < tile.part_length; ++k, factors += kNumGroups * kGroup)
#pragma GCC unroll 8
      for (std::size_t row = 0; row < kRows; ++row)
#pragma GCC unroll 8
        for (std::size_t i = 0; i < kAcross; ++i)
          sums[row][i] +=
              rows[row * tile.rows.step + k] * Vectors::At(factors + i * kLength).values;
  }
#pragma GCC unroll 8
  for (std::size_t row = 0; row < kRows; ++row)
#pragma GCC unroll 8
    for (std::size_t i = 0; i < kAcross; ++i)
      StoreFinished<Vectors>(tile.finish, sums[row][i], row * tile.product_step + i * kLength,
                             tile.product);
}

/// The tile that begins at a row.
PARKADE_INLINE Tile From(std::size_t row, Tile tile) {
  tile.rows.data += row * tile.rows.step;
  tile.product += row * tile.product_step;
  if (tile.finish.added != nullptr) tile.finish.added += row * tile.product_step;
  return tile;
}

/// All rows of one panel of columns.
template <typename Vectors, std::size_t kNumGroups>
PARKADE_INLINE void MultiplyPanel(const Tile& tile) {
  constexpr std::size_t kRows = kTileRows<Vectors>;
  const std::size_t num_rows = tile.rows.count, num_in_tiles = num_rows - num_rows % kRows;
  for (std::size_t row = 0; row < num_in_tiles; row += kRows)
    MultiplyTile<Vectors, kRows, kNumGroups>(From(row, tile));
  for (std::size_t row = num_in_tiles; row < num_rows; ++row)
    MultiplyTile<Vectors, 1, kNumGroups>(From(row, tile));
}

/// A panel of columns after the other.
template <typename Vectors>
PARKADE_INLINE void MultiplyPanels(const MatrixRows& rows, const PackedMatrix& matrix,
                                   const LayerFinish& finish, float* product) {
  const std::size_t num_groups = matrix.num_groups();
  const auto depth = static_cast<std::size_t>(matrix.depth());
  Tile tile{rows, matrix.data(), depth / rows.num_parts, finish, product, num_groups * kGroup};
  for (std::size_t group = 0; group < num_groups; group += kPanel) {
    const std::size_t offset = group * kGroup;
    tile.panel = matrix.data() + offset * depth;
    tile.product = product + offset;
    if (finish.bias != nullptr) tile.finish.bias = finish.bias + offset;
    if (finish.added != nullptr) tile.finish.added = finish.added + offset;
    switch (num_groups - group) {
      case 1: MultiplyPanel<Vectors, 1>(tile); break;
      case 2: MultiplyPanel<Vectors, 2>(tile); break;
      default: MultiplyPanel<Vectors, 3>(tile);
    }
  }
}

}  // namespace

PackedMatrix::PackedMatrix(int depth, int width, const std::function<float(int, int)>& element)
    : depth_(depth), num_groups_(RoundUpToGroup(static_cast<std::size_t>(width)) / kGroup) {
  float* to = packed_.AtLeast(static_cast<std::size_t>(depth) * num_groups_ * kGroup);
  const int panel = static_cast<int>(kPanel * kGroup);
  const int end = static_cast<int>(num_groups_ * kGroup);
  for (int first = 0; first < end; first += panel)
    for (int row = 0; row < depth; ++row)
      for (int column = first; column < std::min(first + panel, end); ++column)
        *to++ = column < width ? element(row, column) : 0;
}

void Multiply(const MatrixRows& rows, const PackedMatrix& matrix, const LayerFinish& finish,
              float* product) {
  RunInVectors([&](auto vectors) PARKADE_INLINE_CALL {
    MultiplyPanels<decltype(vectors)>(rows, matrix, finish, product);
  });
}

}  // namespace parkade
