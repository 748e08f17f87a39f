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

PlaceWords::PlaceWords(const std::vector<RigKeyframe>& keyframes) {
  for (const RigKeyframe& keyframe : keyframes) Add(keyframe);
}

void PlaceWords::Add(const RigKeyframe& keyframe) {
  static_assert(kNumWords == kTables << kBits);
  std::vector<std::uint32_t> words;
  for (int row = 0; row < keyframe.descriptors.rows; ++row)
    for (int table = 0; table < kTables; ++table)
      words.push_back(WordOf(keyframe.descriptors.ptr(row), table));
  std::sort(words.begin(), words.end());
  words.erase(std::unique(words.begin(), words.end()), words.end());
  of_keyframes_.emplace_back(words.begin(), words.end());  // no larger than they are
}

}  // namespace parkade
