#include "mapping/evaluation/height_drift.h"

#include <algorithm>
#include <climits>
#include <cmath>

#include "core/math/fast_floor.h"
#include "core/math/statistics.h"

namespace parkade {
namespace {

constexpr double kSide = 2;  // [m] of a square
constexpr double kMaxHeight =
    1.5;  // [m] to the ground around: a steep ramp over kReach, less than from deck to deck

}  // namespace

HeightDrift::Square HeightDrift::SquareOf(const Eigen::Vector3d& point) {
  return {FastFloor(point.y() / kSide), FastFloor(point.x() / kSide), FastFloor(point.z())};
}

void HeightDrift::Add(const Eigen::Vector3d& point, double difference) {
  Sum& sum = sums_[SquareOf(point)];
  sum.point += point;
  sum.difference += difference;
  ++sum.count;
}

void HeightDrift::Finish() {
  for (const auto& [square, sum] : sums_) around_[square] = FindAround(square);
}

HeightDrift::Around HeightDrift::FindAround(const Square& square) const {
  constexpr int kSteps = static_cast<int>(kReach / kSide);
  const Sum& here = sums_.at(square);
  const Eigen::Vector3d place = here.point / here.count;
  std::vector<double> differences;
  for (int y = square[0] - kSteps; y <= square[0] + kSteps; ++y) {
    const auto end = sums_.upper_bound({y, square[1] + kSteps, INT_MAX});
    for (auto at = sums_.lower_bound({y, square[1] - kSteps, INT_MIN}); at != end; ++at) {
      const Eigen::Vector3d offset = at->second.point / at->second.count - place;
      if (offset.head<2>().norm() > kReach || std::abs(offset.z()) > kMaxHeight) continue;
      differences.push_back(at->second.difference / at->second.count);
    }
  }
  Around around{.median = Median(differences)};
  around.sigma = MadSigma(std::move(differences), around.median);
  return around;
}

}  // namespace parkade
