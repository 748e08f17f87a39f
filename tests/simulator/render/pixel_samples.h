#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/simulator/render/shading.h"

namespace parkade::simulator {

/// What the samples of a pixel saw. Textures are averaged over what a ray covers; what is not are
/// edges: outlines, creases and shadows.
class PixelSamples {
 public:
  /// Null for the sky.
  void Add(const Color& color, const SurfacePoint* surface) {
    const float brightness = color.sum();
    light += color;
    darkest_ = std::min(darkest_, brightness);
    brightest_ = std::max(brightest_, brightness);
    const Seen seen(surface);
    if (++count == 1) first_ = seen;
    is_cut_ = is_cut_ || !first_.IsContinuedBy(seen);
  }

  /// Whether the samples see unlike things in unlike light.
  bool IsEdge() const { return is_cut_ && IsUnlike(darkest_, brightest_); }

  /// Whether an edge runs between two neighbors.
  bool IsCutFrom(const PixelSamples& other) const {
    return count > 0 && other.count > 0 && !first_.IsContinuedBy(other.first_) &&
           IsUnlike(std::min(darkest_, other.darkest_), std::max(brightest_, other.brightest_));
  }

  Color light = Gray(0);  ///< summed
  int count = 0, num_drivable = 0;
  std::array<std::uint8_t, kNumSurfaceClasses> classes{};  ///< samples of each

 private:
  static bool IsUnlike(float darkest, float brightest) {
    constexpr float kLeastShareOfBrightest = 0.82f;
    return darkest < kLeastShareOfBrightest * brightest;
  }

  /// What one ray met.
  struct Seen {
    Eigen::Vector3f position = Eigen::Vector3f::Zero(), normal = Eigen::Vector3f::Zero();
    MaterialId material = 0;
    bool is_sky = true, is_ground = false, is_sunlit = false;

    Seen() = default;
    explicit Seen(const SurfacePoint* surface) {
      if (!surface) return;
      position = surface->position, normal = surface->flat_normal;
      material = surface->material;
      is_sky = false, is_ground = surface->is_ground, is_sunlit = surface->sun > 0;
    }

    bool IsContinuedBy(const Seen& other) const {
      constexpr float kStep = 0.02f;  // [m]
      if (is_sky || other.is_sky) return is_sky && other.is_sky;
      return is_ground == other.is_ground && material == other.material &&
             is_sunlit == other.is_sunlit && normal.dot(other.normal) > 0.95f &&
             (is_ground || std::abs(normal.dot(other.position - position)) < kStep);
    }
  };

  Seen first_;
  float darkest_ = std::numeric_limits<float>::max(), brightest_ = 0;
  bool is_cut_ = false;
};

/// Samples of a whole image, row by row.
using ImageSamples = std::vector<std::vector<PixelSamples>>;

/// Whether an edge runs through a pixel, or along its rim, where no sample has seen it.
inline bool HasEdge(const ImageSamples& rows, size_t row, size_t column) {
  const PixelSamples& pixel = rows[row][column];
  if (pixel.IsEdge()) return true;
  const auto is_cut_from = [&](const PixelSamples& other) {
    return !other.IsEdge() && pixel.IsCutFrom(other);
  };
  return (column > 0 && is_cut_from(rows[row][column - 1])) ||
         (column + 1 < rows[row].size() && is_cut_from(rows[row][column + 1])) ||
         (row > 0 && is_cut_from(rows[row - 1][column])) ||
         (row + 1 < rows.size() && is_cut_from(rows[row + 1][column]));
}

}  // namespace parkade::simulator
