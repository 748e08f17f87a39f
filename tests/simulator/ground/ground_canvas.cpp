#include "tests/simulator/ground/ground_canvas.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace parkade::simulator {
namespace {

constexpr std::uint32_t kMarking = 1u << 24;

std::uint32_t Encode(const Color& color) {
  const Color scaled = color.max(0.0f).min(1.0f).sqrt() * 255.0f + 0.5f;
  return static_cast<std::uint32_t>(scaled[0]) | static_cast<std::uint32_t>(scaled[1]) << 8 |
         static_cast<std::uint32_t>(scaled[2]) << 16;
}

/// The square root of the reflectance, times 255.
Color Unpack(std::uint32_t texel) {
  return Color(static_cast<float>(texel & 255u), static_cast<float>(texel >> 8 & 255u),
               static_cast<float>(texel >> 16 & 255u), 0);
}

Color Decode(const Color& unpacked) { return (unpacked * (1 / 255.0f)).square(); }

}  // namespace

GroundCanvas::GroundCanvas(const Eigen::Vector2d& min, const Eigen::Vector2d& max,
                           double texel_size)
    : min_(min.cast<float>()), texel_size_(static_cast<float>(texel_size)) {
  Level finest;
  finest.width = static_cast<int>(std::ceil((max.x() - min.x()) / texel_size));
  finest.height = static_cast<int>(std::ceil((max.y() - min.y()) / texel_size));
  finest.texels.resize(static_cast<size_t>(finest.width) * static_cast<size_t>(finest.height));
  levels_.push_back(std::move(finest));
}

Eigen::Vector2d GroundCanvas::max() const {
  const Level& level = levels_.front();
  return min() + texel_size() * Eigen::Vector2d(level.width, level.height);
}

void GroundCanvas::Fill(const std::function<Color(float x, float y)>& color) {
  Level& level = levels_.front();
  ParallelFor(static_cast<size_t>(level.height), [&](size_t row) {
    std::uint32_t* texels = level.texels.data() + row * static_cast<size_t>(level.width);
    const float y = min_.y() + (static_cast<float>(row) + 0.5f) * texel_size_;
    for (int column = 0; column < level.width; ++column)
      texels[column] =
          Encode(color(min_.x() + (static_cast<float>(column) + 0.5f) * texel_size_, y));
  });
}

void GroundCanvas::Paint(const Eigen::Vector2d& center, double reach,
                         const std::function<Touch(float x, float y)>& brush) {
  Level& level = levels_.front();
  const Eigen::Vector2f low =
      ((center.cast<float>() - min_).array() - static_cast<float>(reach)) / texel_size_;
  const Eigen::Vector2f high =
      ((center.cast<float>() - min_).array() + static_cast<float>(reach)) / texel_size_;
  const int first_column = std::max(0, static_cast<int>(low.x())),
            last_column = std::min(level.width - 1, static_cast<int>(high.x()));
  const int first_row = std::max(0, static_cast<int>(low.y())),
            last_row = std::min(level.height - 1, static_cast<int>(high.y()));
  const auto paint_row = [&](int row) {
    const float y = min_.y() + (static_cast<float>(row) + 0.5f) * texel_size_;
    for (int column = first_column; column <= last_column; ++column) {
      const Touch touch = brush(min_.x() + (static_cast<float>(column) + 0.5f) * texel_size_, y);
      if (touch.cover <= 0) continue;
      std::uint32_t& texel =
          level.texels[static_cast<size_t>(row) * static_cast<size_t>(level.width) +
                       static_cast<size_t>(column)];
      const bool is_covered = touch.cover > 0.5f;
      const std::uint32_t mark = is_covered && touch.is_marking      ? kMarking
                                 : is_covered && touch.hides_marking ? 0
                                                                     : texel & kMarking;
      texel = Encode(Decode(Unpack(texel)) * (1 - touch.cover) + touch.color * touch.cover) | mark;
    }
  };
  constexpr int kManyRows = 1000;
  if (last_row - first_row < kManyRows)
    for (int row = first_row; row <= last_row; ++row) paint_row(row);
  else
    ParallelFor(static_cast<size_t>(last_row - first_row + 1),
                [&](size_t index) { paint_row(first_row + static_cast<int>(index)); });
}

void GroundCanvas::Finish() {
  while (levels_.back().width > 4 && levels_.back().height > 4) {
    const Level& fine = levels_.back();
    Level coarse;
    coarse.width = fine.width / 2;
    coarse.height = fine.height / 2;
    coarse.texels.resize(static_cast<size_t>(coarse.width) * static_cast<size_t>(coarse.height));
    ParallelFor(static_cast<size_t>(coarse.height), [&](size_t row) {
      const std::uint32_t* above = fine.texels.data() + 2 * row * static_cast<size_t>(fine.width);
      const std::uint32_t* below = above + fine.width;
      for (int column = 0; column < coarse.width; ++column) {
        const Color mean =
            0.25f * (Decode(Unpack(above[2 * column])) + Decode(Unpack(above[2 * column + 1])) +
                     Decode(Unpack(below[2 * column])) + Decode(Unpack(below[2 * column + 1])));
        coarse.texels[row * static_cast<size_t>(coarse.width) + static_cast<size_t>(column)] =
            Encode(mean);
      }
    });
    levels_.push_back(std::move(coarse));
  }
}

Color GroundCanvas::SampleLevel(const Level& level, float column, float row) const {
  const float x = std::clamp(column, 0.0f, static_cast<float>(level.width) - 1.001f);
  const float y = std::clamp(row, 0.0f, static_cast<float>(level.height) - 1.001f);
  const int left = static_cast<int>(x), top = static_cast<int>(y);
  const float fx = x - static_cast<float>(left), fy = y - static_cast<float>(top);
  const std::uint32_t* upper =
      level.texels.data() + static_cast<size_t>(top) * static_cast<size_t>(level.width) + left;
  const std::uint32_t* lower = upper + level.width;
  return Decode((Unpack(upper[0]) * (1 - fx) + Unpack(upper[1]) * fx) * (1 - fy) +
                (Unpack(lower[0]) * (1 - fx) + Unpack(lower[1]) * fx) * fy);
}

Color GroundCanvas::Sample(float x, float y, float footprint) const {
  const float u = (x - min_.x()) / texel_size_, v = (y - min_.y()) / texel_size_;
  const float place = std::max(0.0f, std::log2(std::max(footprint, 1e-6f) / texel_size_));
  const size_t fine = std::min(static_cast<size_t>(place), levels_.size() - 1),
               coarse = std::min(fine + 1, levels_.size() - 1);
  const float fraction = std::min(1.0f, place - static_cast<float>(fine));
  const auto at = [&](size_t index) {
    const float scale = 1.0f / static_cast<float>(1 << index);
    return SampleLevel(levels_[index], u * scale - 0.5f, v * scale - 0.5f);
  };
  const Color sharp = at(fine);
  return fraction > 0 && coarse != fine ? Color(sharp * (1 - fraction) + at(coarse) * fraction)
                                        : sharp;
}

bool GroundCanvas::IsMarking(float x, float y) const {
  const Level& level = levels_.front();
  const int column = static_cast<int>((x - min_.x()) / texel_size_),
            row = static_cast<int>((y - min_.y()) / texel_size_);
  if (column < 0 || row < 0 || column >= level.width || row >= level.height) return false;
  return (level.texels[static_cast<size_t>(row) * static_cast<size_t>(level.width) +
                       static_cast<size_t>(column)] &
          kMarking) != 0;
}

}  // namespace parkade::simulator
