#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <vector>

namespace parkade {

/// How far the heights of one map are off those of another around a place. Poses of a drive drift
/// by centimeters over a ramp, and whole decks with them; ground that was raised or lowered is so
/// beside the ground around it.
class HeightDrift {
 public:
  struct Around {
    double median = 0;  ///< [m] of what is within kReach
    double sigma = 0;   ///< [m] robust spread: 1.48 times the median of absolute deviations
  };

  static constexpr double kReach =
      10;  ///< [m] horizontally: of that half may have changed and is found nevertheless

  /// \param difference  [m] later minus earlier height, at a point of ground that is known in both
  void Add(const Eigen::Vector3d& point, double difference);

  /// Call it once all points are there, before At. O(number of squares of 2 m).
  void Finish();

  /// The drift within 2 m of an added point.
  Around At(const Eigen::Vector3d& point) const { return around_.at(SquareOf(point)); }

 private:
  using Square = std::array<int, 3>;  ///< y, x, height
  struct Sum {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    double difference = 0;
    int count = 0;
  };

  static Square SquareOf(const Eigen::Vector3d& point);
  Around FindAround(const Square& square) const;

  std::map<Square, Sum> sums_;
  std::map<Square, Around> around_;
};

}  // namespace parkade
