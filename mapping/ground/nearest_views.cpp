#include "mapping/ground/nearest_views.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace parkade {

std::vector<bool> ChooseNearest(std::vector<TargetView> target_views, std::size_t num_views,
                                std::vector<int> wanted) {
  const auto by_view = [](const TargetView& a, const TargetView& b) {
    return std::tie(a.view, a.target) < std::tie(b.view, b.target);
  };
  std::sort(target_views.begin(), target_views.end(), by_view);
  std::vector<std::size_t> nearest_first(target_views.size());
  std::iota(nearest_first.begin(), nearest_first.end(), std::size_t{0});
  std::stable_sort(nearest_first.begin(), nearest_first.end(), [&](std::size_t a, std::size_t b) {
    return target_views[a].distance < target_views[b].distance;
  });
  std::vector<bool> is_chosen(num_views);
  for (const std::size_t i : nearest_first) {
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

}  // namespace parkade
