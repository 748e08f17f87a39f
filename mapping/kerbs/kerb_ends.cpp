#include "mapping/kerbs/kerb_ends.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

namespace parkade {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

constexpr double kWindow = 6;            // [m] of a kerb that its end is judged by
constexpr double kReach = 25;            // [m] to other kerbs on the same line
constexpr double kOnLine = 0.15;         // [m]
constexpr std::size_t kMinOwn = 4;       // places of the end itself on its line ...
constexpr double kMinShare = 0.75;       // ... of all there, or so many others as well
constexpr std::size_t kMinOnLine = 12;   // places, of all kerbs
constexpr double kMinSpan = 2.0;         // [m] between two places that give a line
constexpr double kMaxHook = 1.5;         // [m] of an end, around the corner of a car
constexpr double kMinRectangular = 0.6;  // of all directions' mean, turned by four times the angle
constexpr int kMinAcross = 3;            // places along each of the two directions
constexpr double kMaxBack = 0.35, kMaxOn = 2.0;  // [rad] that the next side is turned from an end
constexpr double kSide = 5;           // [m] from an end to places that stand for the next side
constexpr double kMaxHiddenSide = 3;  // [m] of a side that nothing but a corner tells of
constexpr double kWeightOfSide = 3;
constexpr std::size_t kNearby = 6;  // places from an end to one that tells its direction

/// Looks for the line that most places lie on.
class LineSearch {
 public:
  /// \param window  of the kerb itself
  LineSearch(std::span<const KerbPlace> window, std::span<const KerbPlace> others, double sign,
             const Vector2d& outward)
      : window_(window), others_(others), sign_(sign), outward_(outward) {
    for (std::size_t i = 0; i < window.size(); i += 2) {
      for (std::size_t k = i + 1; k < window.size(); ++k) Try(window[i], window[k]);
      for (std::size_t k = 0; k < others.size(); k += 2) Try(window[i], others[k]);
    }
  }

  const std::vector<KerbPlace>& own() const { return own_; }
  const std::vector<KerbPlace>& of_others() const { return of_others_; }

 private:
  void Try(const KerbPlace& a, const KerbPlace& b) {
    const Vector2d between = (a.foot - b.foot).head<2>();
    if (between.norm() < kMinSpan) return;
    const Vector2d direction =
        between.dot(outward_) < 0 ? -between.normalized() : between.normalized();
    std::vector<KerbPlace> own = OnLine(window_, a.foot.head<2>(), direction);
    if (own.size() < kMinOwn) return;
    std::vector<KerbPlace> of_others = OnLine(others_, a.foot.head<2>(), direction);
    if (own.size() + of_others.size() <= own_.size() + of_others_.size()) return;
    own_ = std::move(own), of_others_ = std::move(of_others);
  }

  std::vector<KerbPlace> OnLine(std::span<const KerbPlace> places, const Vector2d& from,
                                const Vector2d& direction) const {
    std::vector<KerbPlace> found;
    std::ranges::copy_if(places, std::back_inserter(found), [&](const KerbPlace& place) {
      return std::abs(Beside(place.foot.head<2>() - from, direction)) <= kOnLine &&
             sign_ * place.along.dot(direction) >= KerbPlace::kParallel;
    });
    return found;
  }

  std::span<const KerbPlace> window_, others_;
  double sign_;
  Vector2d outward_;
  std::vector<KerbPlace> own_, of_others_;
};

/// What else may tell where the end of a kerb leads: the kerb itself beyond the window, and others.
std::vector<KerbPlace> OthersNear(const Vector3d& foot, std::span<const KerbPlace> rest,
                                  std::span<const KerbPlace> all, std::size_t kerb) {
  std::vector<KerbPlace> others;
  const auto is_near = [&](const KerbPlace& place) {
    return (place.foot - foot).norm() <= kReach &&
           std::abs(place.foot.z() - foot.z()) <= KerbPlace::kSameDeck;
  };
  std::ranges::copy_if(rest, std::back_inserter(others), is_near);
  std::ranges::copy_if(all, std::back_inserter(others), [&](const KerbPlace& place) {
    return place.kerb != kerb && is_near(place);
  });
  return others;
}

/// Whether enough places lie along an axis, and enough across it.
bool HasTwoDirections(std::span<const KerbPlace> places, double axis) {
  const Vector2d direction(std::cos(axis), std::sin(axis));
  const auto num_along = std::ranges::count_if(places, [&](const KerbPlace& place) {
    return std::abs(place.along.dot(direction)) >= KerbPlace::kParallel;
  });
  const auto num_across = std::ranges::count_if(places, [&](const KerbPlace& place) {
    return std::abs(Beside(place.along, direction)) >= KerbPlace::kParallel;
  });
  return std::min(num_along, num_across) >= kMinAcross;
}

}  // namespace

std::vector<Vector3d> Spaced(const std::vector<Vector3d>& line) {
  std::vector<Vector3d> points{line.front()};
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Vector3d between = line[i] - line[i - 1];
    const int count =
        std::max(1, static_cast<int>(std::lround(between.norm() / KerbPlace::kSpacing)));
    for (int k = 1; k <= count; ++k)
      points.push_back(line[i - 1] + static_cast<double>(k) / count * between);
  }
  return points;
}

std::vector<KerbPlace> PlacesAlong(const Kerb& kerb, std::size_t index) {
  const std::vector<Vector3d> feet = Spaced(kerb.points);
  std::vector<KerbPlace> places;
  places.reserve(feet.size());
  for (std::size_t i = 0; i < feet.size(); ++i) {
    const Vector3d between =
        feet[std::min(i + 1, feet.size() - 1)] - feet[i - std::min<std::size_t>(i, 1)];
    places.push_back({feet[i], between.head<2>().normalized(), index});
  }
  return places;
}

KerbAxis FitAxis(std::span<const KerbPlace> places, const Vector2d& toward) {
  Vector3d middle = Vector3d::Zero();
  double weights = 0;
  for (const KerbPlace& place : places)
    middle += place.weight * place.foot, weights += place.weight;
  KerbAxis line{middle / weights, toward};
  double xx = 0, xy = 0, yy = 0;
  for (const KerbPlace& place : places) {
    const Vector3d off = place.foot - line.middle;
    xx += place.weight * off.x() * off.x();
    xy += place.weight * off.x() * off.y();
    yy += place.weight * off.y() * off.y();
  }
  const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
  line.direction = {std::cos(angle), std::sin(angle)};
  if (line.direction.dot(toward) < 0) line.direction = -line.direction;
  double rise = 0, square = 0;
  for (const KerbPlace& place : places) {
    const double along = line.Along(place.foot);
    rise += place.weight * along * (place.foot.z() - line.middle.z());
    square += place.weight * along * along;
  }
  line.slope = square > 0 ? rise / square : 0;
  return line;
}

KerbEnd FindEnd(std::span<const KerbPlace> own, double sign, std::span<const KerbPlace> all) {
  const auto window =
      own.first(std::min(own.size(), static_cast<std::size_t>(kWindow / KerbPlace::kSpacing)));
  KerbEnd end;
  end.foot = end.start = own.front().foot;
  const Vector3d& nearby = window[std::min(window.size() - 1, kNearby)].foot;
  end.outward = (end.foot - nearby).head<2>().normalized();
  const std::vector<KerbPlace> others =
      OthersNear(end.foot, own.subspan(window.size()), all, own.front().kerb);
  const LineSearch found(window, others, sign, end.outward);
  const bool is_straight =
      static_cast<double>(found.own().size()) >= kMinShare * static_cast<double>(window.size());
  if (found.own().size() + found.of_others().size() < kMinOnLine ||
      (!is_straight && found.of_others().size() < kMinOwn))
    return end;
  const auto first = std::ranges::find_if(
      window, [&](const KerbPlace& place) { return place.foot == found.own().front().foot; });
  const double hook = KerbPlace::kSpacing * static_cast<double>(first - window.begin());
  if (hook > kMaxHook) return end;
  end.hook = hook;
  end.start = first->foot;
  end.on_line = found.own();
  std::ranges::copy(found.of_others(), std::back_inserter(end.on_line));
  end.line = FitAxis(end.on_line, end.outward);
  return end;
}

std::vector<KerbEnd> AroundCorners(const KerbEnd& end, std::span<const KerbPlace> places,
                                   double left) {
  double cosines = 0, sines = 0;
  for (const KerbPlace& place : places) {
    const double angle = std::atan2(place.along.y(), place.along.x());
    cosines += std::cos(4 * angle), sines += std::sin(4 * angle);
  }
  if (std::hypot(cosines, sines) < kMinRectangular * static_cast<double>(places.size())) return {};
  const double axis = std::atan2(sines, cosines) / 4;
  if (!HasTwoDirections(places, axis)) return {};
  const double outward = std::atan2(end.outward.y(), end.outward.x());
  std::vector<std::pair<double, double>> sides;  // by how far they turn away from the ground
  for (int i = 0; i < 4; ++i) {
    const double angle = axis + i * std::numbers::pi / 2;
    const double turn = left * std::remainder(outward - angle, 2 * std::numbers::pi);
    if (turn >= -kMaxBack && turn <= kMaxOn) sides.emplace_back(turn, angle);
  }
  std::ranges::sort(sides);
  std::vector<KerbEnd> ways;
  ways.reserve(sides.size());
  for (const auto& [turn, angle] : sides) {
    KerbEnd& way = ways.emplace_back();
    way.foot = way.start = end.foot;
    way.max_hidden = kMaxHiddenSide;
    way.outward = {std::cos(angle), std::sin(angle)};
    for (const double along : {-kSide, kSide}) {
      Vector3d foot = end.foot;
      foot.head<2>() += along * way.outward;
      way.on_line.push_back({foot, way.outward, places.front().kerb, kWeightOfSide});
    }
    way.line = FitAxis(way.on_line, way.outward);
  }
  return ways;
}

}  // namespace parkade
