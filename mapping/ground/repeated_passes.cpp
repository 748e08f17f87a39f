#include "mapping/ground/repeated_passes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

namespace parkade {
namespace {

constexpr double kStretch = 0.5;   // [m] of travel that are kept or not together
constexpr double kTurn = 0.09;     // [rad], or so much turning
constexpr double kAside = 0.8;     // [m] between two passes of a place
constexpr double kAngle = 0.26;    // [rad] between their headings
constexpr double kSameDeck = 1.0;  // [m] between their heights
constexpr double kAway = 5.0;      // [m] of travel after which the car may have come by again

/// Where the car was at the begin of a stretch.
struct Stop {
  Rigid3 odom_from_body;
  double traveled = 0;  ///< [m]
};

bool IsSamePlace(const Stop& a, const Stop& b) {
  const Eigen::Vector3d apart = a.odom_from_body.translation - b.odom_from_body.translation;
  return apart.head<2>().norm() <= kAside && std::abs(apart.z()) <= kSameDeck &&
         a.odom_from_body.rotation.angularDistance(b.odom_from_body.rotation) <= kAngle;
}

/// Stops that are kept, by place.
class KeptStops {
 public:
  void Add(const Stop& stop) { squares_[KeyOf(SquareOf(stop))].push_back(stop); }

  /// How many passes lead by a stop, apart from its own.
  int CountPasses(const Stop& stop) const {
    std::vector<double> traveled;
    const Eigen::Vector2i home = SquareOf(stop);
    for (int x = home.x() - 1; x <= home.x() + 1; ++x)
      for (int y = home.y() - 1; y <= home.y() + 1; ++y)
        if (const auto found = squares_.find(KeyOf({x, y})); found != squares_.end())
          for (const Stop& other : found->second)
            if (std::abs(other.traveled - stop.traveled) > kAway && IsSamePlace(stop, other))
              traveled.push_back(other.traveled);
    std::sort(traveled.begin(), traveled.end());
    int count = 0;
    for (size_t i = 0; i < traveled.size(); ++i)
      if (i == 0 || traveled[i] - traveled[i - 1] > kAway) ++count;
    return count;
  }

 private:
  static Eigen::Vector2i SquareOf(const Stop& stop) {
    const Eigen::Vector2d at = stop.odom_from_body.translation.head<2>();
    constexpr double kFarthest = 1e9;  // squares; no drive goes there
    return (at / kAside).array().floor().max(-kFarthest).min(kFarthest).matrix().cast<int>();
  }
  static std::uint64_t KeyOf(const Eigen::Vector2i& square) {
    return std::uint64_t{static_cast<std::uint32_t>(square.x())} << 32 |
           static_cast<std::uint32_t>(square.y());
  }

  std::unordered_map<std::uint64_t, std::vector<Stop>> squares_;
};

}  // namespace

RepeatedPasses::RepeatedPasses(const Trajectory& odom_from_body, int passes) {
  if (passes == 0) return;
  std::vector<Stop> stops;
  Stop now;
  const TrajectoryState* before = nullptr;
  for (const TrajectoryState& state : odom_from_body.states()) {
    now.odom_from_body = state.world_from_body;
    if (before)
      now.traveled +=
          (state.world_from_body.translation - before->world_from_body.translation).norm();
    before = &state;
    if (!stops.empty() && now.traveled - stops.back().traveled < kStretch &&
        now.odom_from_body.rotation.angularDistance(stops.back().odom_from_body.rotation) < kTurn)
      continue;
    stops.push_back(now);
    times_.push_back(state.time);
  }
  is_repeated_.assign(stops.size(), true);
  KeptStops early, late;
  const auto keep = [&](size_t stop, KeptStops& kept, int at_most) {
    if (kept.CountPasses(stops[stop]) >= at_most) return;
    kept.Add(stops[stop]);
    is_repeated_[stop] = false;
  };
  for (size_t i = 0; i < stops.size(); ++i) keep(i, early, passes / 2);
  for (size_t i = stops.size(); i-- > 0;) keep(i, late, passes - passes / 2);
}

bool RepeatedPasses::Contains(Timestamp time) const {
  const auto after = std::upper_bound(times_.begin(), times_.end(), time);
  return after != times_.begin() && is_repeated_[static_cast<size_t>(after - times_.begin()) - 1];
}

}  // namespace parkade
