#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace parkade {

/// A view shows a target; both by their numbers.
struct TargetView {
  float distance = 0;  ///< [m] between them
  std::uint32_t view = 0;
  std::uint32_t target = 0;
};

/// Chooses views so that each target is shown by as many as it wants, or by all that show it.
/// Views of targets are gone through from the nearest on; a view that is taken for one target
/// counts for all that it shows, so that these may get others than their own nearest. Views from
/// the same place tell alike: more of them cost time and add little.
///
/// \param wanted  number of views by target
/// \return by view
std::vector<bool> ChooseNearest(std::vector<TargetView> target_views, std::size_t num_views,
                                std::vector<int> wanted);

/// The nearest chosen views of each target, as many as it wants. \return by target view
std::vector<bool> NearestOfChosen(std::span<const TargetView> target_views,
                                  const std::vector<bool>& is_chosen, std::vector<int> wanted);

}  // namespace parkade
