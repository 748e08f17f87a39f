#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

namespace parkade {

constexpr int kDescriptorBytes = 32;  ///< of a binary descriptor (ORB)

/// The number of bits in which two descriptors differ.
int HammingDistance(const uchar* a, const uchar* b);

/// The descriptor that is nearest to another one, and how near the second comes.
struct NearestDescriptor {
  int index = -1;  ///< the first of equals; -1: there is none
  int distance = 8 * kDescriptorBytes, second_distance = 8 * kDescriptorBytes;

  /// Takes in one more.
  void Add(int its_index, int its_distance) {
    if (its_distance < distance) {
      second_distance = distance;
      distance = its_distance;
      index = its_index;
    } else {
      second_distance = std::min(second_distance, its_distance);
    }
  }

  /// The index, or nothing when it is further than `max_distance` [bits], or two are alike: further
  /// than `ratio` times the second.
  std::optional<std::size_t> Found(int max_distance, double ratio) const {
    if (index < 0 || distance > max_distance || distance > ratio * second_distance) return {};
    return static_cast<std::size_t>(index);
  }
};

/// Eight descriptors side by side, word by word; those that are not there are zeros.
struct DescriptorBlock {
  static constexpr int kAbreast = 8;
  std::array<std::array<std::uint64_t, kAbreast>, kDescriptorBytes / 8> words{};
};

/// Descriptors to search, laid out as vectors of a processor compare them: 0.6 ns a row where it
/// counts bits of vectors (AVX512-VPOPCNTDQ), else 2 ns.
class DescriptorSet {
 public:
  /// \param descriptors  CV_8UC1, 32 bytes a row; copied
  explicit DescriptorSet(const cv::Mat& descriptors);

  NearestDescriptor FindNearest(const uchar* descriptor) const;

 private:
  std::vector<DescriptorBlock> blocks_;
  int rows_ = 0;
};

}  // namespace parkade
