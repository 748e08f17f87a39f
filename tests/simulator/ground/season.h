#pragma once

#include <functional>
#include <string>

#include "tests/simulator/ground/ground_painter.h"

namespace parkade::simulator {

/// What the time of the year lays on a ground in the open.
enum class Season {
  kUsual,   ///< a little litter
  kAutumn,  ///< leaves in drifts along kerbs, some everywhere
  kWinter,  ///< snow, deep at kerbs, thin or gone where cars drive; heaps in a lot's free slots
};

/// "usual", "autumn", "winter". Throws Error{kUsage} for others.
Season SeasonOf(const std::string& name);

/// Lays leaves or snow on a painted ground.
/// \param from_rim  [m] from a point to the next kerb; not positive where there is no road
void LaySeason(Season season, const std::function<double(const Eigen::Vector2d&)>& from_rim,
               GroundPainter& painter);

}  // namespace parkade::simulator
