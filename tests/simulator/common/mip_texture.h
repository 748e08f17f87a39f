#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace parkade::simulator {

/// What a surface looks like close up.
enum class TextureKind : std::uint8_t {
  kNone,
  kAggregate,
  kLeaves,
  kBrick,
  kPlaster,
  kBark,
  kGrass,
  kSlabs,
  kConcrete,
  kGravel,
  kTiles,
  kCobbles,
  kMulch
};
inline constexpr int kNumTextureKinds = 13;

/// A small gray texture that repeats, with all its averaged levels, so that it is
/// never sampled finer than the eye sees it. Values are relative deviations of
/// brightness around 0, of root mean square 1.
class MipTexture {
 public:
  /// `value(column, row)` for a square of 2^log2_size texels.
  MipTexture(int log2_size, const std::function<float(int, int)>& value);

  /// Mean over about `footprint` periods around (u, v), both in periods; trilinear.
  float Sample(float u, float v, float footprint) const;

 private:
  float SampleLevel(size_t level, float u, float v) const;

  int log2_size_;
  std::vector<std::vector<float>> levels_;
};

/// The texture of a kind; made at first use, the same for every scene.
/// Thread-safe. kNone has none: throws std::out_of_range.
const MipTexture& DetailTexture(TextureKind kind);

}  // namespace parkade::simulator
