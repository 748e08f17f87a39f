#include "mapping/ground/nearest_views.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace parkade {
namespace {

/// Indices, the nearest first; of equals in their order.
std::vector<std::size_t> NearestFirst(std::span<const TargetView> target_views) {
  std::vector<std::size_t> indices(target_views.size());
  std::iota(indices.begin(), indices.end(), std::size_t{0});
  std::stable_sort(indices.begin(), indices.end(), [&](std::size_t a, std::size_t b) {
    return target_views[a].distance < target_views[b].distance;
  });
  return indices;
}

}  // namespace

std::vector<bool> ChooseNearest(std::vector<TargetView> target_views, std::size_t num_views,
                                std::vector<int> wanted) {
  const auto by_view = [](const TargetView& a, const TargetView& b) {
    return std::tie(a.view, a.target) < std::tie(b.view, b.target);
  };
  std::sort(target_views.begin(), target_views.end(), by_view);
  std::vector<bool> is_chosen(num_views);
  for (const std::size_t i : NearestFirst(target_views)) {
    const TargetView& wanting = target_views[i];
    if (wanted[wanting.target] <= 0 || is_chosen[wanting.view]) continue;
    is_chosen[wanting.view] = true;
    const auto [begin, end] =
        std::equal_range(target_views.begin(), target_views.end(), wanting,
                         [](const TargetView& a, const TargetView& b) { return a.view < b.view; });
    std::for_each(begin, end, [&](const TargetView& shown) { --wanted[shown.target]; });
  }
  return is_chosen;
}

std::vector<bool> NearestOfChosen(std::span<const TargetView> target_views,
                                  const std::vector<bool>& is_chosen, std::vector<int> wanted) {
  std::vector<bool> is_nearest(target_views.size());
  for (const std::size_t i : NearestFirst(target_views))
    is_nearest[i] = is_chosen[target_views[i].view] && wanted[target_views[i].target]-- > 0;
  return is_nearest;
}

}  // namespace parkade
