#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace parkade {

/// Which of numbered things lie in a square of an unbounded grid: in the order in which they were
/// added. Squares are kept in blocks, and blocks are found in a table that spans them all, so that
/// looking one up costs two looks into arrays; what lies far off the rest is found in a list.
/// Reading is thread-safe.
class PatchIndex {
 public:
  static constexpr int kNone = -1;

  /// The first thing at (x, y), or kNone.
  int First(int x, int y) const {
    const int block = FindBlock(x >> kBits, y >> kBits);
    return block == kNone ? kNone : blocks_[static_cast<std::size_t>(block)][SquareOf(x, y)];
  }

  /// The one after it in the same square, or kNone.
  int Next(int thing) const { return next_[static_cast<std::size_t>(thing)]; }

  /// Things are numbered from 0 in the order in which they are added.
  void Add(int x, int y) {
    const auto thing = static_cast<int>(next_.size());
    next_.push_back(kNone);
    int block = FindBlock(x >> kBits, y >> kBits);
    if (block == kNone) block = AddBlock(x >> kBits, y >> kBits);
    int* last = &blocks_[static_cast<std::size_t>(block)][SquareOf(x, y)];
    while (*last != kNone) last = &next_[static_cast<std::size_t>(*last)];
    *last = thing;
  }

 private:
  static constexpr int kBits = 6;
  static constexpr int kSide = 1 << kBits;
  static constexpr std::int64_t kMaxTable = 1 << 20;  // blocks
  using Block = std::array<int, static_cast<std::size_t>(kSide) * kSide>;

  /// Numbers of the blocks in a rectangle.
  struct Table {
    std::int64_t x = 0, y = 0, width = 0, height = 0;
    std::vector<int> blocks;

    bool Holds(int column, int row) const {
      return column >= x && column < x + width && row >= y && row < y + height;
    }
    int& At(std::int64_t column, std::int64_t row) {
      return blocks[static_cast<std::size_t>((row - y) * width + (column - x))];
    }
    int At(std::int64_t column, std::int64_t row) const {
      return blocks[static_cast<std::size_t>((row - y) * width + (column - x))];
    }
  };

  static std::size_t SquareOf(int x, int y) {
    return static_cast<std::size_t>(y & (kSide - 1)) * kSide +
           static_cast<std::size_t>(x & (kSide - 1));
  }

  int FindBlock(int x, int y) const {
    if (table_.Holds(x, y)) return table_.At(x, y);
    if (far_.empty()) return kNone;
    const auto found = far_.find({x, y});
    return found == far_.end() ? kNone : found->second;
  }

  int AddBlock(int x, int y) {
    const auto block = static_cast<int>(blocks_.size());
    blocks_.emplace_back().fill(kNone);
    if (!table_.Holds(x, y)) GrowTable(x, y);
    if (table_.Holds(x, y))
      table_.At(x, y) = block;
    else
      far_.emplace(std::pair(x, y), block);
    return block;
  }

  /// So that it holds (x, y), unless it became too large.
  void GrowTable(std::int64_t x, std::int64_t y) {
    Table grown{x, y, 1, 1, {}};
    if (table_.width > 0) {
      grown.x = std::min(x, table_.x), grown.y = std::min(y, table_.y);
      grown.width = std::max(x + 1, table_.x + table_.width) - grown.x;
      grown.height = std::max(y + 1, table_.y + table_.height) - grown.y;
    }
    if (grown.width > kMaxTable || grown.height > kMaxTable / grown.width) return;
    grown.blocks.assign(static_cast<std::size_t>(grown.width * grown.height), kNone);
    for (std::int64_t row = table_.y; row < table_.y + table_.height; ++row)
      for (std::int64_t column = table_.x; column < table_.x + table_.width; ++column)
        grown.At(column, row) = table_.At(column, row);
    for (const auto& [at, block] : far_)
      if (grown.Holds(at.first, at.second)) grown.At(at.first, at.second) = block;
    table_ = std::move(grown);
  }

  std::vector<Block> blocks_;
  Table table_;
  std::map<std::pair<int, int>, int> far_;  // blocks off the table
  std::vector<int> next_;
};

}  // namespace parkade
