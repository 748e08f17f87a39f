#pragma once

#include <opencv2/core/mat.hpp>

namespace parkade {

constexpr int kDescriptorBytes = 32;  ///< of a binary descriptor (ORB)

/// The number of bits in which two descriptors differ.
int HammingDistance(const uchar* a, const uchar* b);

/// The descriptor that is nearest to another one, and how near the second comes.
struct NearestDescriptor {
  int index = -1;  ///< the first of equals; -1: there is none
  int distance = 8 * kDescriptorBytes, second_distance = 8 * kDescriptorBytes;
};

/// Finds it among the rows of `descriptors` (CV_8UC1, 32 bytes each). About 2 ns per row.
NearestDescriptor FindNearestDescriptor(const uchar* descriptor, const cv::Mat& descriptors);

}  // namespace parkade
