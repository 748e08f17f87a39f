#include "export/lanelet2/simplify_ring.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_map>

namespace parkade {
namespace {

using Eigen::Vector2d;

constexpr double kBucket = 1.0;      // [m]
constexpr double kRounding = 1e-9;   // [m^2] by which a straight line may seem to bend
constexpr double kClearance = 2e-3;  // [m] that a new line keeps from corners: files round to 1 mm

double Cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// A ring whose corners are taken out one by one.
class ShrinkingRing {
 public:
  ShrinkingRing(const Ring& ring, double tolerance, std::vector<bool> is_fixed)
      : tolerance_(tolerance),
        is_fixed_(std::move(is_fixed)),
        is_left_(ring.size(), true),
        next_(ring.size()),
        previous_(ring.size()) {
    for (size_t i = 0; i < ring.size(); ++i) {
      points_.emplace_back(ring[i].head<2>());
      next_[i] = (i + 1) % ring.size();
      previous_[i] = (i + ring.size() - 1) % ring.size();
      buckets_[KeyOf(points_[i])].push_back(i);
    }
  }

  /// The corners that are left once no more can be taken out. Those with the least ground go first.
  std::vector<bool> TakeOut() {
    std::set<std::pair<double, size_t>> waiting;
    for (size_t i = 0; i < points_.size(); ++i) waiting.emplace(AreaOf(i), i);
    size_t num_left = points_.size();
    while (!waiting.empty() && num_left > 3) {
      const size_t i = waiting.begin()->second;
      waiting.erase(waiting.begin());
      if (!CanGo(i)) continue;
      const size_t before = previous_[i], after = next_[i];
      for (const size_t neighbor : {before, after}) waiting.erase({AreaOf(neighbor), neighbor});
      is_left_[i] = false;
      next_[before] = after;
      previous_[after] = before;
      --num_left;
      for (const size_t neighbor : {before, after}) waiting.emplace(AreaOf(neighbor), neighbor);
    }
    return is_left_;
  }

 private:
  static std::int64_t KeyOf(const Vector2d& point) {
    return CellKey(static_cast<int>(std::floor(point.x() / kBucket)),
                   static_cast<int>(std::floor(point.y() / kBucket)));
  }

  /// [m^2] that the ring loses without the corner; negative where it bends to the right.
  double AreaOf(size_t i) const {
    const Vector2d &from = points_[previous_[i]], &to = points_[next_[i]];
    return 0.5 * Cross(points_[i] - from, to - points_[i]);
  }

  bool CanGo(size_t i) const {
    const Vector2d &from = points_[previous_[i]], &to = points_[next_[i]];
    if (is_fixed_[i] || AreaOf(i) < -kRounding || (to - from).norm() < kClearance) return false;
    for (size_t k = (previous_[i] + 1) % points_.size(); k != next_[i];
         k = (k + 1) % points_.size())
      if (DistanceToLine(points_[k], from, to) > tolerance_) return false;
    return IsClear(i);
  }

  static double DistanceToLine(const Vector2d& point, const Vector2d& from, const Vector2d& to) {
    const Vector2d along = to - from;
    const double share = std::clamp((point - from).dot(along) / along.squaredNorm(), 0.0, 1.0);
    return (point - from - share * along).norm();
  }

  /// Whether the triangle that goes with the corner holds no other corner: then the ring without it
  /// does not cross itself.
  bool IsClear(size_t i) const {
    const Vector2d &from = points_[previous_[i]], &corner = points_[i], &to = points_[next_[i]];
    const Vector2d low = from.cwiseMin(corner).cwiseMin(to).array() - kClearance;
    const Vector2d high = from.cwiseMax(corner).cwiseMax(to).array() + kClearance;
    for (double y = std::floor(low.y() / kBucket); y * kBucket <= high.y(); ++y)
      for (double x = std::floor(low.x() / kBucket); x * kBucket <= high.x(); ++x) {
        const auto bucket = buckets_.find(CellKey(static_cast<int>(x), static_cast<int>(y)));
        if (bucket == buckets_.end()) continue;
        for (const size_t k : bucket->second) {
          if (!is_left_[k] || k == i || k == previous_[i] || k == next_[i]) continue;
          if ((points_[k] - low).minCoeff() < 0 || (high - points_[k]).minCoeff() < 0) continue;
          if (IsWithin(points_[k], from, corner, to)) return false;
        }
      }
    return true;
  }

  static bool IsWithin(const Vector2d& point, const Vector2d& a, const Vector2d& b,
                       const Vector2d& c) {
    if (DistanceToLine(point, a, c) < kClearance) return true;
    return Cross(b - a, point - a) >= 0 && Cross(c - b, point - b) >= 0 &&
           Cross(a - c, point - c) >= 0;
  }

  double tolerance_;
  std::vector<bool> is_fixed_, is_left_;
  std::vector<Vector2d> points_;
  std::vector<size_t> next_, previous_;
  std::unordered_map<std::int64_t, std::vector<size_t>> buckets_;
};

}  // namespace

Ring LeaveOutLeftBends(const Ring& ring, double tolerance, std::vector<bool> is_fixed) {
  const std::vector<bool> is_left = ShrinkingRing(ring, tolerance, std::move(is_fixed)).TakeOut();
  Ring simple;
  for (size_t i = 0; i < ring.size(); ++i)
    if (is_left[i]) simple.push_back(ring[i]);
  return simple;
}

Ring LeaveOutRightBends(const Ring& ring, double tolerance, std::vector<bool> is_fixed) {
  std::reverse(is_fixed.begin(), is_fixed.end());
  Ring simple = LeaveOutLeftBends({ring.rbegin(), ring.rend()}, tolerance, std::move(is_fixed));
  std::reverse(simple.begin(), simple.end());
  return simple;
}

}  // namespace parkade
