#include "slam/places/compare_bevs.h"

#include <opencv2/imgproc.hpp>

#include "core/parallel.h"
#include "slam/places/ground_bev.h"
#include "slam/places/weighted_blur.h"

namespace parkade {
namespace {

constexpr int kTile = 32;    // cells
constexpr int kSquare = 11;  // cells: a tile is looked for in squares of this many shifts ...
constexpr int kSquares = 5;  // ... in each direction
constexpr int kReach = kSquare * kSquares / 2;
constexpr double kMinTileSeen = 0.8;
constexpr double kMinSearchSeen = 0.7;
constexpr double kMostAlike = 0.5;  // of a tile with its own surroundings: joints and lines repeat
constexpr size_t kMaxNeighbors = 16;
constexpr double kMaxContrast = 1.5;
constexpr double kContrastSigma = 12;  // cells
constexpr double kNoise = 2;           // gray values that count as no contrast

/// The image over its contrast. Paint counts no more than stains and grain: much of it looks alike
/// elsewhere.
cv::Mat PatternOf(const cv::Mat& floor, const cv::Mat& is_seen) {
  cv::Mat values, weights, contrast;
  floor.convertTo(values, CV_32F, 1, -kFloorGray);
  is_seen.convertTo(weights, CV_32F, 1.0 / 255);
  values = values.mul(weights);
  cv::sqrt(MeanAround(values.mul(values), weights, kContrastSigma), contrast);
  cv::Mat pattern = values / (contrast + kNoise);
  return cv::min(cv::max(pattern, -kMaxContrast), kMaxContrast);
}

double ShareSeen(const cv::Mat& is_seen) {
  return static_cast<double>(cv::countNonZero(is_seen)) / static_cast<double>(is_seen.total());
}

/// How well a tile fits at each shift within what is searched.
cv::Mat FitsOf(const cv::Mat& searched, const cv::Mat& tile) {
  cv::Mat fits;
  cv::matchTemplate(searched, tile, fits, cv::TM_CCORR_NORMED);
  return fits;
}

/// Whether the square in the middle holds the highest agreement of all.
bool FitsBestInTheMiddle(const cv::Mat& agreement) {
  cv::Point best;
  cv::minMaxLoc(agreement, nullptr, nullptr, nullptr, &best);
  return best.x / kSquare == kSquares / 2 && best.y / kSquare == kSquares / 2;
}

/// Whether a tile fits its own surroundings badly everywhere but in the middle square.
bool IsDistinct(const cv::Mat& own_agreement) {
  constexpr int kMiddle = kSquare * (kSquares / 2);
  cv::Mat is_apart(own_agreement.size(), CV_8U, cv::Scalar(1));
  is_apart(cv::Rect(kMiddle, kMiddle, kSquare, kSquare)) = 0;
  double most = 0;
  cv::minMaxLoc(own_agreement, nullptr, &most, nullptr, nullptr, is_apart);
  return most < kMostAlike;
}

}  // namespace

DriveFloors::DriveFloors(const std::vector<RigKeyframe>& keyframes)
    : patterns_(keyframes.size()), is_seen_(keyframes.size()) {
  cv::Mat sum = cv::Mat::zeros(kFloorSize, CV_32FC1), count = sum.clone();
  for (size_t i = 0; i < keyframes.size(); ++i) {
    if (keyframes[i].floor.empty()) continue;
    cv::erode(keyframes[i].floor > 0, is_seen_[i], {}, {-1, -1}, 2);
    patterns_[i] = PatternOf(keyframes[i].floor, is_seen_[i]);
    sum += patterns_[i];
    cv::add(count, 1, count, is_seen_[i]);
  }
  const cv::Mat same = sum / cv::max(count, 1);
  for (size_t i = 0; i < keyframes.size(); ++i)
    if (!patterns_[i].empty()) cv::subtract(patterns_[i], same, patterns_[i], is_seen_[i]);
}

BevAgreement CompareBevs(const DriveFloors& a, size_t keyframe_a, const DriveFloors& b,
                         size_t keyframe_b, const Rigid3& a_from_b) {
  BevAgreement agreement;
  const cv::Mat& own = a.pattern(keyframe_a);
  if (own.empty() || b.pattern(keyframe_b).empty()) return agreement;
  const cv::Matx23f move = MoveOfFloor(a_from_b);
  cv::Mat other, is_seen;
  cv::warpAffine(b.pattern(keyframe_b), other, move, kFloorSize, cv::INTER_LINEAR,
                 cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::warpAffine(b.is_seen(keyframe_b), is_seen, move, kFloorSize, cv::INTER_NEAREST,
                 cv::BORDER_CONSTANT, cv::Scalar(0));
  for (int y = kReach; y + kTile + kReach <= kFloorSize.height; y += kTile / 2) {
    for (int x = kReach; x + kTile + kReach <= kFloorSize.width; x += kTile / 2) {
      const cv::Rect tile(x, y, kTile, kTile);
      const cv::Rect search(x - kReach, y - kReach, kTile + 2 * kReach, kTile + 2 * kReach);
      if (ShareSeen(a.is_seen(keyframe_a)(tile)) < kMinTileSeen ||
          ShareSeen(is_seen(search)) < kMinSearchSeen ||
          !IsDistinct(FitsOf(own(search), own(tile))))
        continue;
      ++agreement.num_tiles;
      if (FitsBestInTheMiddle(FitsOf(other(search), own(tile)))) ++agreement.num_best;
    }
  }
  return agreement;
}

BevAgreement SumOverSome(size_t count, size_t max_count,
                         const std::function<BevAgreement(size_t)>& compare) {
  const size_t num_chosen = std::min(count, max_count);
  BevAgreement sum;
  for (const BevAgreement& agreement :
       ParallelMap(num_chosen, [&](size_t i) { return compare(i * count / num_chosen); }))
    sum += agreement;
  return sum;
}

BevAgreement CompareNeighbors(const DriveFloors& floors,
                              const std::vector<RigKeyframe>& keyframes) {
  return SumOverSome(std::max(keyframes.size(), size_t{1}) - 1, kMaxNeighbors, [&](size_t i) {
    return CompareBevs(
        floors, i, floors, i + 1,
        keyframes[i].odom_from_keyframe.Inverse() * keyframes[i + 1].odom_from_keyframe);
  });
}

}  // namespace parkade
