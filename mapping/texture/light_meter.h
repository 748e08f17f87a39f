#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "mapping/texture/balance_light.h"
#include "mapping/texture/chart_painter.h"

namespace parkade {

/// Looks at the same places in many photos, from which BalanceLight finds their gains and falloffs.
class LightMeter {
 public:
  /// \param places  [m] in site, on the ground, evenly spread; sights beyond `max_range` [m] do not count
  LightMeter(std::vector<Eigen::Vector3d> places, std::size_t num_photos, double max_range);

  /// In parallel over photos; the sums do not depend on the order. `cells` give what a photo's gain is where no other
  /// photo tells (FindGain).
  void Measure(std::span<const GroundPhoto> photos, const CellFinder& cells);

  /// Sets each photo's light, by its index. Logs how much sights of a place differ without it and with it.
  void Balance(std::span<GroundPhoto* const> photos) const;

 private:
  std::vector<std::pair<std::size_t, LightSight>> SightsOf(const GroundPhoto& photo) const;

  std::vector<Eigen::Vector3d> points_;  // by x
  std::vector<LightPlace> places_;
  std::vector<LightPrior> photos_;
  double max_range_;
};

}  // namespace parkade
