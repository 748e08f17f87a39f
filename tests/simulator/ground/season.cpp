#include "tests/simulator/ground/season.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace parkade::simulator {
namespace {

using Eigen::Vector2d;
using RimDistance = std::function<double(const Vector2d&)>;

/// Leaves gather where wind and wheels leave them.
void LayLeaves(const RimDistance& from_rim, GroundPainter& painter) {
  constexpr double kPerSquareMeter = 90, kDrift = 0.8, kAnywhere = 0.03;  // [m]; share
  Random& random = painter.random();
  const GroundCanvas& canvas = painter.canvas();
  const Vector2d extent = canvas.max() - canvas.min();
  for (auto left = static_cast<int>(kPerSquareMeter * extent.prod()); left > 0; --left) {
    const Vector2d at =
        canvas.min() + Vector2d(random.Uniform(), random.Uniform()).cwiseProduct(extent);
    const double away = from_rim(at);
    const double chance = away <= 0 ? 0 : std::max(kAnywhere, std::exp(-away / kDrift));
    if (random.Chance(chance)) painter.Leaf(at);
  }
}

void LaySnow(const RimDistance& from_rim, GroundPainter& painter) {
  painter.Snow([&](const Vector2d& at) {
    constexpr double kBank = 0.5, kFades = 1.8;  // [m] from the rim
    return 1 - (from_rim(at) - kBank) / kFades;
  });
}

}  // namespace

Season SeasonOf(const std::string& name) {
  if (name == "usual") return Season::kUsual;
  if (name == "autumn") return Season::kAutumn;
  Require(name == "winter", ErrorCode::kUsage, "season must be usual, autumn or winter");
  return Season::kWinter;
}

void LaySeason(Season season, const RimDistance& from_rim, GroundPainter& painter) {
  if (season == Season::kAutumn) LayLeaves(from_rim, painter);
  if (season == Season::kWinter) LaySnow(from_rim, painter);
}

}  // namespace parkade::simulator
