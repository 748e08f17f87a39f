#include "slam/places/hamming.h"

#include <bit>
#include <cstring>

// Counting bits is an instruction of nearly every processor, but not of the oldest that we are
// compiled for.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define PARKADE_COUNTS_BITS __attribute__((target_clones("popcnt", "default")))
#define PARKADE_HAS_VECTORS_OF_COUNTS
#else
#define PARKADE_COUNTS_BITS
#endif

namespace parkade {
namespace {

using Words = std::array<std::uint64_t, kDescriptorBytes / 8>;

inline Words Load(const uchar* descriptor) {
  Words words;
  std::memcpy(words.data(), descriptor, sizeof words);
  return words;
}

__attribute__((always_inline)) inline int CountDifferent(const Words& a, const Words& b) {
  int count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += std::popcount(a[i] ^ b[i]);
  return count;
}

/// Adds the rows of a set, eight distances at a time.
__attribute__((always_inline)) inline NearestDescriptor Search(
    const Words& wanted, const std::vector<DescriptorBlock>& blocks, int rows) {
  constexpr int kAbreast = DescriptorBlock::kAbreast;
  NearestDescriptor nearest;
  int first = 0;
  for (const DescriptorBlock& block : blocks) {
    std::array<std::int64_t, kAbreast> distances{};
    for (size_t word = 0; word < wanted.size(); ++word)
      for (size_t i = 0; i < kAbreast; ++i)
        distances[i] += std::popcount(wanted[word] ^ block.words[word][i]);
    std::int64_t least = distances[0];
    for (const std::int64_t distance : distances) least = std::min(least, distance);
    // Nearly no block has anything near enough to matter.
    if (least < nearest.second_distance)
      for (int i = 0; i < std::min(kAbreast, rows - first); ++i)
        nearest.Add(first + i, static_cast<int>(distances[static_cast<size_t>(i)]));
    first += kAbreast;
  }
  return nearest;
}

PARKADE_COUNTS_BITS NearestDescriptor SearchByWords(const Words& wanted,
                                                    const std::vector<DescriptorBlock>& blocks,
                                                    int rows) {
  return Search(wanted, blocks, rows);
}

#ifdef PARKADE_HAS_VECTORS_OF_COUNTS
__attribute__((target("avx512vpopcntdq"))) NearestDescriptor SearchByVectors(
    const Words& wanted, const std::vector<DescriptorBlock>& blocks, int rows) {
  return Search(wanted, blocks, rows);
}
#endif

}  // namespace

PARKADE_COUNTS_BITS int HammingDistance(const uchar* a, const uchar* b) {
  return CountDifferent(Load(a), Load(b));
}

DescriptorSet::DescriptorSet(const cv::Mat& descriptors)
    : blocks_(static_cast<size_t>((descriptors.rows + DescriptorBlock::kAbreast - 1) /
                                  DescriptorBlock::kAbreast)),
      rows_(descriptors.rows) {
  for (int row = 0; row < rows_; ++row) {
    const Words words = Load(descriptors.ptr(row));
    DescriptorBlock& block = blocks_[static_cast<size_t>(row / DescriptorBlock::kAbreast)];
    for (size_t word = 0; word < words.size(); ++word)
      block.words[word][static_cast<size_t>(row % DescriptorBlock::kAbreast)] = words[word];
  }
}

NearestDescriptor DescriptorSet::FindNearest(const uchar* descriptor) const {
  const Words wanted = Load(descriptor);
#ifdef PARKADE_HAS_VECTORS_OF_COUNTS
  static const bool has_vectors = __builtin_cpu_supports("avx512vpopcntdq");
  if (has_vectors) return SearchByVectors(wanted, blocks_, rows_);
#endif
  return SearchByWords(wanted, blocks_, rows_);
}

}  // namespace parkade
