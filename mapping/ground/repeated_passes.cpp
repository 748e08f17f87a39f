#include "mapping/ground/repeated_passes.h"

#include <algorithm>
#include <cmath>

#include "mapping/ground/square_index.h"

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

/// How many passes lead by a stop, apart from its own.
int CountPasses(const Stop& stop, const SquareIndex<Stop>& stops) {
  std::vector<double> traveled;
  stops.VisitAround(stop.odom_from_body.translation.head<2>(), kAside, [&](const Stop& other) {
    if (std::abs(other.traveled - stop.traveled) > kAway && IsSamePlace(stop, other))
      traveled.push_back(other.traveled);
  });
  std::sort(traveled.begin(), traveled.end());
  int count = 0;
  for (size_t i = 0; i < traveled.size(); ++i)
    if (i == 0 || traveled[i] - traveled[i - 1] > kAway) ++count;
  return count;
}

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
  SquareIndex<Stop> early(kAside), late(kAside);
  const auto keep = [&](size_t stop, SquareIndex<Stop>& kept, int at_most) {
    if (CountPasses(stops[stop], kept) >= at_most) return;
    kept.Add(stops[stop].odom_from_body.translation.head<2>(), stops[stop]);
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
