#pragma once

namespace parkade::simulator {

/// Height along a ramp: level, a smooth bend, an even slope, a smooth bend, level;
/// three times differentiable.
struct RampProfile {
  double rise = 2.9;      ///< [m]
  double run = 26;        ///< [m] both bends included
  double transition = 5;  ///< [m] of each bend

  double Slope() const { return rise / (run - transition); }

  /// [m] at `along` [m] from its foot; level beyond both ends.
  double Height(double along) const {
    if (along <= 0) return 0;
    if (along >= run) return rise;
    if (along > run / 2) return rise - Height(run - along);
    if (along >= transition) return Slope() * (along - transition / 2);
    const double u = along / transition;
    return Slope() * transition * u * u * u * (2.5 - 3 * u + u * u) * u;
  }
};

}  // namespace parkade::simulator
