#pragma once

#include <functional>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "slam/places/rig_keyframe.h"

namespace parkade {

/// What is drawn on the ground around each keyframe of a drive: stains, cracks, paint. Light that
/// changes slowly over the floor is taken off, and so is what stays the same along the drive: the
/// car's own body.
class DriveFloors {
 public:
  explicit DriveFloors(const std::vector<RigKeyframe>& keyframes);

  /// CV_32FC1 of kFloorSize, in units of the contrast around each cell; 0 where unseen. Empty
  /// without an image.
  const cv::Mat& pattern(size_t keyframe) const { return patterns_[keyframe]; }
  /// CV_8UC1, 255 where the pattern is known.
  const cv::Mat& is_seen(size_t keyframe) const { return is_seen_[keyframe]; }
  size_t size() const { return patterns_.size(); }

 private:
  std::vector<cv::Mat> patterns_, is_seen_;
};

/// How many tiles of floor were compared, and how many fit best where they should.
struct BevAgreement {
  int num_tiles = 0, num_best = 0;
  double share() const { return num_tiles == 0 ? 0 : static_cast<double>(num_best) / num_tiles; }
  BevAgreement& operator+=(const BevAgreement& other) {
    num_tiles += other.num_tiles;
    num_best += other.num_best;
    return *this;
  }
};

/// What two drives' floors say about whether they are the same ground.
struct BevEvidence {
  BevAgreement within;  ///< each drive with itself, neighboring keyframes: how much its floor shows
  BevAgreement across;  ///< one drive with the other, where links put them
};

/// Lays the floor of one keyframe on that of another: tiles of 1.6 m of the first are looked for in
/// the second within 1.35 m of where `a_from_b` puts them, in 25 squares of 0.55 m. By chance the
/// middle one is the best for one tile in 25. Tiles that look like their own surroundings do not
/// count.
BevAgreement CompareBevs(const DriveFloors& a, size_t keyframe_a, const DriveFloors& b,
                         size_t keyframe_b, const Rigid3& a_from_b);

/// How much a drive's floor shows at all: keyframes all along it are compared with the next ones.
BevAgreement CompareNeighbors(const DriveFloors& floors, const std::vector<RigKeyframe>& keyframes);

/// Sums `compare` over at most `max_count` of the indices below `count`, evenly spread; in
/// parallel.
BevAgreement SumOverSome(size_t count, size_t max_count,
                         const std::function<BevAgreement(size_t)>& compare);

}  // namespace parkade
