#include "slam/places/hamming.h"

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

// Counting bits is an instruction of nearly every processor, but not of the oldest that we are
// compiled for.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define PARKADE_COUNTS_BITS __attribute__((target_clones("popcnt", "default")))
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

}  // namespace

PARKADE_COUNTS_BITS int HammingDistance(const uchar* a, const uchar* b) {
  return CountDifferent(Load(a), Load(b));
}

PARKADE_COUNTS_BITS NearestDescriptor FindNearestDescriptor(const uchar* descriptor,
                                                            const cv::Mat& descriptors) {
  const Words wanted = Load(descriptor);
  NearestDescriptor nearest;
  for (int row = 0; row < descriptors.rows; ++row)
    nearest.Add(row, CountDifferent(wanted, Load(descriptors.ptr(row))));
  return nearest;
}

}  // namespace parkade
