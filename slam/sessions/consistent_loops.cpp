#include "slam/sessions/consistent_loops.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace parkade {
namespace {

constexpr double kClosingDegreesPerMeter = 0.02;

bool Agree(const SessionLoop& first, const SessionLoop& second,
           const std::vector<RigKeyframe>& keyframes_a, const std::vector<RigKeyframe>& keyframes_b,
           const SessionLoopOptions& options) {
  const RigKeyframe &first_a = keyframes_a[first.keyframe_a],
                    &second_a = keyframes_a[second.keyframe_a];
  const RigKeyframe &first_b = keyframes_b[first.keyframe_b],
                    &second_b = keyframes_b[second.keyframe_b];
  // The second link's keyframe b in the first link's keyframe a, by either way around.
  const Rigid3 by_a =
      first_a.odom_from_keyframe.Inverse() * second_a.odom_from_keyframe * second.pose.a_from_b;
  const Rigid3 by_b =
      first.pose.a_from_b * first_b.odom_from_keyframe.Inverse() * second_b.odom_from_keyframe;
  const double way = std::abs(second_a.distance - first_a.distance) +
                     std::abs(second_b.distance - first_b.distance);
  const double sigmas = 3 * std::hypot(first.pose.worst_sigma, second.pose.worst_sigma);
  const double max_turn = (options.closing_deg + kClosingDegreesPerMeter * way) * M_PI / 180;
  // A rotation within its bound shifts what lies far away.
  const double lever = (by_b.translation - first.pose.a_from_b.translation).norm();
  const double max_apart = options.closing_base + options.closing_per_meter * way + sigmas +
                           std::sin(options.closing_deg * M_PI / 180) * lever;
  return (by_a.translation - by_b.translation).norm() < max_apart &&
         by_a.rotation.angularDistance(by_b.rotation) < max_turn;
}

}  // namespace

std::vector<size_t> FindConsistentLoops(const std::vector<RigKeyframe>& keyframes_a,
                                        const std::vector<RigKeyframe>& keyframes_b,
                                        const std::vector<SessionLoop>& links,
                                        const SessionLoopOptions& options) {
  const size_t count = links.size();
  std::vector<std::vector<bool>> agrees(count, std::vector<bool>(count));
  std::vector<size_t> degree(count), order(count);
  for (size_t i = 0; i < count; ++i)
    for (size_t j = i + 1; j < count; ++j)
      if (Agree(links[i], links[j], keyframes_a, keyframes_b, options)) {
        agrees[i][j] = agrees[j][i] = true;
        ++degree[i];
        ++degree[j];
      }
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return degree[a] > degree[b]; });
  std::vector<size_t> best;
  constexpr size_t kStarts = 30;  // the likeliest members, each begins a set
  for (size_t start = 0; start < std::min(count, kStarts); ++start) {
    if (degree[order[start]] + 1 <= best.size()) break;
    std::vector<size_t> set = {order[start]};
    for (const size_t candidate : order)
      if (std::all_of(set.begin(), set.end(),
                      [&](size_t member) { return agrees[member][candidate]; }))
        set.push_back(candidate);
    if (set.size() > best.size()) best = std::move(set);
  }
  std::sort(best.begin(), best.end());
  return best;
}

}  // namespace parkade
