#pragma once

#include <functional>
#include <vector>

namespace parkade::simulator {

/// How the body leans when the car accelerates and turns: two damped springs (1.3 Hz, a third of
/// critical damping), as of a small car.
class Suspension {
 public:
  /// Acceleration [m/s^2] toward the front and to the left, at a time [s].
  struct Push {
    double forward = 0, left = 0;
  };

  /// Over [0, duration]; before, the car is taken to have stood as at time 0. `softness` scales the
  /// lean; 0: none.
  Suspension(const std::function<Push(double)>& push_at, double duration, double softness);

  // [rad], C2-smooth; clamped to the ends.
  double Pitch(double time) const;  ///< positive lowers the nose
  double Roll(double time) const;   ///< positive lowers the right side

 private:
  struct Spring {
    double angle = 0, rate = 0;
  };
  double At(const std::vector<Spring>& samples, double time) const;

  std::vector<Spring> pitch_, roll_;
};

}  // namespace parkade::simulator
