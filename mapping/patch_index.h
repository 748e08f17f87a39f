#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace parkade {

/// Which of numbered things lie in a square of an unbounded grid: in the order in which they were added. Squares are
/// kept in blocks, so that looking one up costs one look into a short list of blocks and one into an array. Reading is
/// thread-safe.
class PatchIndex {
 public:
  static constexpr int kNone = -1;

  /// The first thing at (x, y), or kNone.
  int First(int x, int y) const {
    const auto block = blocks_.find(KeyOf(x >> kBits, y >> kBits));
    return block == blocks_.end() ? kNone : block->second[SquareOf(x, y)];
  }

  /// The one after it in the same square, or kNone.
  int Next(int thing) const { return next_[static_cast<std::size_t>(thing)]; }

  /// Things are numbered from 0 in the order in which they are added.
  void Add(int x, int y) {
    const auto thing = static_cast<int>(next_.size());
    next_.push_back(kNone);
    const auto [block, is_new] = blocks_.try_emplace(KeyOf(x >> kBits, y >> kBits));
    if (is_new) block->second.fill(kNone);
    int* last = &block->second[SquareOf(x, y)];
    while (*last != kNone) last = &next_[static_cast<std::size_t>(*last)];
    *last = thing;
  }

 private:
  static constexpr int kBits = 6;
  static constexpr int kSide = 1 << kBits;
  using Block = std::array<int, static_cast<std::size_t>(kSide) * kSide>;

  static std::uint64_t KeyOf(int x, int y) {
    return (std::uint64_t{static_cast<std::uint32_t>(x)} << 32) | static_cast<std::uint32_t>(y);
  }
  static std::size_t SquareOf(int x, int y) {
    return static_cast<std::size_t>(y & (kSide - 1)) * kSide + static_cast<std::size_t>(x & (kSide - 1));
  }

  std::unordered_map<std::uint64_t, Block> blocks_;
  std::vector<int> next_;
};

}  // namespace parkade
