#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace parkade {

/// A view that shows something, by their numbers.
struct ViewOf {
  float distance = 0;  ///< [m] between them
  std::uint32_t view = 0;
  std::uint32_t target = 0;
};

/// Chooses views so that each target is shown by as many as it wants, or by all that show it: the
/// nearest first, which then stand for all else that they show. Views from the same place tell
/// alike, so that more of them cost time and add little.
/// \param wanted  number of views by target
/// \return by view
std::vector<bool> ChooseNearest(std::vector<ViewOf> views_of_targets, std::size_t num_views,
                                std::vector<int> wanted);

}  // namespace parkade
