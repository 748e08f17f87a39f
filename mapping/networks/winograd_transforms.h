#pragma once

#include <cstddef>

#include "mapping/networks/matrix_product.h"

namespace parkade {

constexpr int kWinogradTile = 4;   ///< [px] of output, a side
constexpr int kWinogradPatch = 6;  ///< [px] of input that such a tile depends on, a side
constexpr std::size_t kWinogradPlanes = kWinogradPatch * kWinogradPatch;

/// Pixels of whole groups of channels: those of one row lie `step` floats apart, rows `row_step`.
struct PatchSteps {
  std::size_t step = 0, row_step = 0;
};

/// B^T d B of a patch, all channels: element k goes to `planes` + k * `plane_step`.
void TransformPatch(const float* patch, const PatchSteps& steps, float* planes,
                    std::size_t plane_step);

/// A^T m A of what lies in planes the same way, with what is to be done with sums; writes the upper
/// left `rows` x `columns` of the tile.
struct WinogradTile {
  float* data = nullptr;
  PatchSteps steps;
  int rows = kWinogradTile, columns = kWinogradTile;
  LayerFinish finish;  ///< `added` is that of the tile's upper left
};
void TransformSums(const float* planes, std::size_t plane_step, const WinogradTile& tile);

}  // namespace parkade
