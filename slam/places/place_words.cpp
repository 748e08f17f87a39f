#include "slam/places/place_words.h"

#include <algorithm>
#include <array>

namespace parkade {
namespace {

constexpr int kTables = 4;
constexpr int kBits = 16;

/// Positions of bits in a descriptor that make up the words: a fixed shuffle.
std::array<int, kTables * kBits> ChooseBits() {
  std::array<int, 256> bits{};
  for (int i = 0; i < 256; ++i) bits[static_cast<size_t>(i)] = i;
  std::uint32_t random = 12345;
  for (size_t i = 255; i > 0; --i) {
    random = random * 1664525u + 1013904223u;
    std::swap(bits[i], bits[(random >> 8) % (i + 1)]);
  }
  std::array<int, kTables * kBits> chosen{};
  std::copy_n(bits.begin(), chosen.size(), chosen.begin());
  return chosen;
}

std::uint32_t WordOf(const uchar* descriptor, int table) {
  static const std::array<int, kTables* kBits> chosen = ChooseBits();
  auto word = static_cast<std::uint32_t>(table);
  for (int i = 0; i < kBits; ++i) {
    const int bit = chosen[static_cast<size_t>(table * kBits + i)];
    word = 2 * word + ((descriptor[bit / 8] >> (bit % 8)) & 1u);
  }
  return word;
}

}  // namespace

PlaceWords::PlaceWords(const std::vector<RigKeyframe>& keyframes)
    : num_keyframes_(keyframes.size()) {
  for (size_t i = 0; i < keyframes.size(); ++i)
    for (int row = 0; row < keyframes[i].descriptors.rows; ++row)
      for (int table = 0; table < kTables; ++table)
        entries_.push_back(
            {WordOf(keyframes[i].descriptors.ptr(row), table), static_cast<std::uint32_t>(i)});
  std::sort(entries_.begin(), entries_.end());
  entries_.erase(std::unique(entries_.begin(), entries_.end()), entries_.end());
}

}  // namespace parkade
