#include "mapping/ground/nearest_views.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace parkade {

std::vector<bool> ChooseNearest(std::vector<Sighting> sightings, std::size_t num_views,
                                std::vector<int> wanted) {
  const auto by_view = [](const Sighting& a, const Sighting& b) {
    return std::tie(a.view, a.target) < std::tie(b.view, b.target);
  };
  std::sort(sightings.begin(), sightings.end(), by_view);
  std::vector<std::size_t> nearest_first(sightings.size());
  std::iota(nearest_first.begin(), nearest_first.end(), std::size_t{0});
  std::stable_sort(nearest_first.begin(), nearest_first.end(), [&](std::size_t a, std::size_t b) {
    return sightings[a].distance < sightings[b].distance;
  });
  std::vector<bool> is_chosen(num_views);
  for (const std::size_t i : nearest_first) {
    const Sighting& wanting = sightings[i];
    if (wanted[wanting.target] <= 0 || is_chosen[wanting.view]) continue;
    is_chosen[wanting.view] = true;
    const auto [begin, end] =
        std::equal_range(sightings.begin(), sightings.end(), wanting,
                         [](const Sighting& a, const Sighting& b) { return a.view < b.view; });
    std::for_each(begin, end, [&](const Sighting& shown) { --wanted[shown.target]; });
  }
  return is_chosen;
}

}  // namespace parkade
