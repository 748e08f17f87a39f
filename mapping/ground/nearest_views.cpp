#include "mapping/ground/nearest_views.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace parkade {

std::vector<bool> ChooseNearest(std::vector<ViewOf> views_of_targets, std::size_t num_views,
                                std::vector<int> wanted) {
  const auto by_view = [](const ViewOf& a, const ViewOf& b) {
    return std::tie(a.view, a.target) < std::tie(b.view, b.target);
  };
  std::sort(views_of_targets.begin(), views_of_targets.end(), by_view);
  std::vector<std::size_t> nearest_first(views_of_targets.size());
  std::iota(nearest_first.begin(), nearest_first.end(), std::size_t{0});
  std::stable_sort(nearest_first.begin(), nearest_first.end(), [&](std::size_t a, std::size_t b) {
    return views_of_targets[a].distance < views_of_targets[b].distance;
  });
  std::vector<bool> is_chosen(num_views);
  for (const std::size_t i : nearest_first) {
    const ViewOf& wanting = views_of_targets[i];
    if (wanted[wanting.target] <= 0 || is_chosen[wanting.view]) continue;
    is_chosen[wanting.view] = true;
    const auto [begin, end] =
        std::equal_range(views_of_targets.begin(), views_of_targets.end(), wanting,
                         [](const ViewOf& a, const ViewOf& b) { return a.view < b.view; });
    std::for_each(begin, end, [&](const ViewOf& shown) { --wanted[shown.target]; });
  }
  return is_chosen;
}

}  // namespace parkade
