#include "tests/simulator/common/mip_texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "tests/simulator/common/noise.h"

namespace parkade::simulator {
namespace {

constexpr int kLog2Size = 9;
constexpr int kSize = 1 << kLog2Size;

/// SmoothNoise that repeats after `cells` lattice cells over the texture.
float PeriodicNoise(int column, int row, int cells, std::uint32_t seed) {
  const float scale = static_cast<float>(cells) / kSize;
  const float x = static_cast<float>(column) * scale, y = static_cast<float>(row) * scale;
  const int ix = static_cast<int>(x), iy = static_cast<int>(y);
  const float fx = x - static_cast<float>(ix), fy = y - static_cast<float>(iy);
  const float sx = fx * fx * (3 - 2 * fx), sy = fy * fy * (3 - 2 * fy);
  const auto at = [&](int i, int j) { return CellValue(i % cells, j % cells, seed); };
  return (at(ix, iy) * (1 - sx) + at(ix + 1, iy) * sx) * (1 - sy) +
         (at(ix, iy + 1) * (1 - sx) + at(ix + 1, iy + 1) * sx) * sy;
}

/// Octaves from `coarsest` cells over the texture, each `gain` times the one before.
float PeriodicFractal(int column, int row, int coarsest, int octaves, float gain,
                      std::uint32_t seed) {
  float sum = 0, amplitude = 1;
  for (int octave = 0, cells = coarsest; octave < octaves && cells <= kSize; ++octave, cells *= 2) {
    sum += amplitude * PeriodicNoise(column, row, cells, seed + static_cast<std::uint32_t>(octave));
    amplitude *= gain;
  }
  return sum;
}

/// Courses of bricks in half bond, 16 high and 8 long over the texture.
float BrickValue(int column, int row) {
  const int course = row / 32;
  const int shifted = (column + (course % 2) * 32) % kSize;
  const bool is_mortar = row % 32 < 3 || shifted % 64 < 3;
  const float brick = CellValue(shifted / 64, course, 91);
  return (is_mortar ? 1.6f : 0.8f * brick) + 0.5f * PeriodicFractal(column, row, 64, 3, 0.7f, 92);
}

/// Paving slabs in a grid of 8 by 8, each of its own gray, stained.
float SlabValue(int column, int row) {
  const int shifted = (column + (row / 64 % 2) * 32) % kSize;
  const bool is_joint = row % 64 < 2 || shifted % 64 < 2;
  return (is_joint ? -2.2f : 0.7f * CellValue(shifted / 64, row / 64, 71)) +
         0.9f * PeriodicFractal(column, row, 8, 6, 0.75f, 72);
}

/// Cast concrete: marks of the boards, pores, and stains.
float ConcreteValue(int column, int row) {
  const bool is_joint = row % 128 < 2 || (column + (row / 128 % 2) * 128) % 256 < 2;
  const float pores = std::max(0.0f, PeriodicNoise(column, row, 96, 81) - 0.6f);
  return (is_joint ? -1.5f : 0.5f * CellValue(column / 256, row / 128, 82)) - 3.5f * pores +
         1.1f * PeriodicFractal(column, row, 4, 7, 0.7f, 83);
}

/// Distance [texels] to the nearest of points that lie at random in a lattice of `cells` by `cells`
/// over the texture, and to the next one. Repeats.
std::pair<float, float> NearestPoints(int column, int row, int cells, std::uint32_t seed) {
  const int side = kSize / cells, x = column / side, y = row / side;
  float nearest = 1e9f, next = 1e9f;
  for (int j = y - 1; j <= y + 1; ++j)
    for (int i = x - 1; i <= x + 1; ++i) {
      const int at_x = (i + cells) % cells, at_y = (j + cells) % cells;
      const auto place = [&](int cell, std::uint32_t stream) {
        const float shift = 0.5f + 0.35f * CellValue(at_x, at_y, seed + stream);
        return (static_cast<float>(cell) + shift) * static_cast<float>(side);
      };
      const float distance = std::hypot(place(i, 0) - static_cast<float>(column),
                                        place(j, 1) - static_cast<float>(row));
      next = std::min(next, std::max(nearest, distance));
      nearest = std::min(nearest, distance);
    }
  return {nearest, next};
}

/// Stones of 64 to a side, each of its own gray, dark between them.
float GravelValue(int column, int row) {
  const auto [nearest, next] = NearestPoints(column, row, 64, 101);
  const float stone = CellValue(column / 8, row / 8, 103);
  return 0.8f * stone + 0.35f * std::min(next - nearest, 3.0f) +
         0.7f * PeriodicFractal(column, row, 4, 4, 0.8f, 104);
}

/// Large square tiles in a grid of 8 by 8 with thin joints, hardly a stain.
float TileValue(int column, int row) {
  const bool is_joint = row % 64 < 2 || column % 64 < 2;
  return (is_joint ? -3.0f : 0.6f * CellValue(column / 64, row / 64, 111)) +
         0.4f * PeriodicFractal(column, row, 16, 5, 0.7f, 112);
}

/// Rounded stones, 16 to a side, in dark joints.
float CobbleValue(int column, int row) {
  const auto [nearest, next] = NearestPoints(column, row, 16, 121);
  return 1.5f * std::min((next - nearest) / 6, 1.0f) - 0.03f * nearest +
         0.6f * PeriodicFractal(column, row, 16, 5, 0.7f, 123);
}

/// Chips of bark.
float MulchValue(int column, int row) {
  return PeriodicFractal(column, 2 * row % kSize, 32, 4, 0.8f, 131) +
         PeriodicFractal(2 * column % kSize, row, 32, 4, 0.8f, 132);
}

float TextureValue(TextureKind kind, int column, int row) {
  switch (kind) {
    case TextureKind::kAggregate: {
      // Stones in a dark binder: flat tops of middle-sized noise with bright exceptions.
      const float stones = PeriodicFractal(column, row, 64, 4, 0.85f, 11);
      const float bright = PeriodicNoise(column, row, 128, 15);
      return stones + 2.5f * std::max(0.0f, bright - 0.55f);
    }
    case TextureKind::kLeaves: {
      const float leaves = PeriodicFractal(column, row, 24, 5, 0.8f, 21);
      return leaves + 1.2f * std::max(0.0f, PeriodicNoise(column, row, 48, 27)) -
             1.5f * std::max(0.0f, PeriodicNoise(column, row, 16, 28) - 0.2f);
    }
    case TextureKind::kBrick: return BrickValue(column, row);
    case TextureKind::kPlaster: return PeriodicFractal(column, row, 4, 8, 0.62f, 41);
    case TextureKind::kBark: return PeriodicFractal(4 * column % kSize, row, 16, 4, 0.7f, 51);
    case TextureKind::kGrass: return PeriodicFractal(column, row, 8, 7, 0.85f, 61);
    case TextureKind::kSlabs: return SlabValue(column, row);
    case TextureKind::kConcrete: return ConcreteValue(column, row);
    case TextureKind::kGravel: return GravelValue(column, row);
    case TextureKind::kTiles: return TileValue(column, row);
    case TextureKind::kCobbles: return CobbleValue(column, row);
    case TextureKind::kMulch: return MulchValue(column, row);
    case TextureKind::kNone: break;
  }
  throw std::out_of_range("no texture of this kind");
}

}  // namespace

MipTexture::MipTexture(int log2_size, const std::function<float(int, int)>& value)
    : log2_size_(log2_size) {
  const int size = 1 << log2_size;
  std::vector<float> finest(static_cast<size_t>(size) * static_cast<size_t>(size));
  double sum = 0, sum_squares = 0;
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      const float x = value(column, row);
      finest[static_cast<size_t>(row * size + column)] = x;
      sum += x;
      sum_squares += x * x;
    }
  }
  const double count = static_cast<double>(finest.size()), mean = sum / count;
  const double sigma = std::sqrt(std::max(1e-12, sum_squares / count - mean * mean));
  for (float& x : finest) x = static_cast<float>((x - mean) / sigma);
  levels_.push_back(std::move(finest));
  for (int level_size = size / 2; level_size >= 1; level_size /= 2) {
    const std::vector<float>& fine = levels_.back();
    std::vector<float> coarse(static_cast<size_t>(level_size * level_size));
    for (int row = 0; row < level_size; ++row) {
      for (int column = 0; column < level_size; ++column) {
        const size_t first = static_cast<size_t>(4 * row * level_size + 2 * column),
                     below = first + static_cast<size_t>(2 * level_size);
        coarse[static_cast<size_t>(row * level_size + column)] =
            0.25f * (fine[first] + fine[first + 1] + fine[below] + fine[below + 1]);
      }
    }
    levels_.push_back(std::move(coarse));
  }
}

float MipTexture::SampleLevel(size_t level, float u, float v) const {
  const int size = 1 << (log2_size_ - static_cast<int>(level));
  const int wrap = size - 1;
  const float x = u * static_cast<float>(size) - 0.5f, y = v * static_cast<float>(size) - 0.5f;
  const int column = FastFloorToInt(x), row = FastFloorToInt(y);
  const float fx = x - static_cast<float>(column), fy = y - static_cast<float>(row);
  const int left = column & wrap, top = row & wrap;
  const int right = (left + 1) & wrap, bottom = (top + 1) & wrap;
  const float* texels = levels_[level].data();
  const float upper = texels[top * size + left] * (1 - fx) + texels[top * size + right] * fx;
  const float lower = texels[bottom * size + left] * (1 - fx) + texels[bottom * size + right] * fx;
  return upper * (1 - fy) + lower * fy;
}

float MipTexture::Sample(float u, float v, float footprint) const {
  const float place = std::log2(std::max(footprint, 1e-6f) * static_cast<float>(1 << log2_size_));
  if (place <= 0) return SampleLevel(0, u, v);
  const size_t level = static_cast<size_t>(place);
  // The last levels of a texture of mean zero are zero but for rounding.
  if (level + 1 >= levels_.size()) return 0;
  const float fraction = place - static_cast<float>(level);
  return SampleLevel(level, u, v) * (1 - fraction) + SampleLevel(level + 1, u, v) * fraction;
}

const MipTexture& DetailTexture(TextureKind kind) {
  static const std::vector<MipTexture> textures = [] {
    std::vector<MipTexture> made;
    for (int i = 1; i < kNumTextureKinds; ++i)
      made.emplace_back(kLog2Size, [i](int column, int row) {
        return TextureValue(static_cast<TextureKind>(i), column, row);
      });
    return made;
  }();
  return textures.at(static_cast<size_t>(static_cast<int>(kind) - 1));
}

}  // namespace parkade::simulator
