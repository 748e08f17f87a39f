#include "tests/simulator/motion/suspension.h"

#include <algorithm>
#include <cmath>

namespace parkade::simulator {
namespace {

constexpr double kStep = 0.005;                                                 // [s]
constexpr double kPitchPerAcceleration = -0.004, kRollPerAcceleration = 0.006;  // [rad/(m/s^2)]
constexpr double kFrequency = 2 * M_PI * 1.3, kDamping = 0.33;  // [rad/s], of critical

}  // namespace

Suspension::Suspension(const std::function<Push(double)>& push_at, double duration,
                       double softness) {
  const auto follow = [](Spring spring, double wanted) {
    const double pull =
        kFrequency * kFrequency * (wanted - spring.angle) - 2 * kDamping * kFrequency * spring.rate;
    spring.rate += kStep * pull;
    spring.angle += kStep * spring.rate;
    return spring;
  };
  const Push first = push_at(0);
  Spring pitch{softness * kPitchPerAcceleration * first.forward, 0},
      roll{softness * kRollPerAcceleration * first.left, 0};
  for (int i = 0; i * kStep <= duration + kStep; ++i) {
    pitch_.push_back(pitch);
    roll_.push_back(roll);
    const Push push = push_at((i + 0.5) * kStep);
    pitch = follow(pitch, softness * kPitchPerAcceleration * push.forward);
    roll = follow(roll, softness * kRollPerAcceleration * push.left);
  }
}

/// Cubic between samples, by their rates.
double Suspension::At(const std::vector<Spring>& samples, double time) const {
  const double place = std::clamp(time / kStep, 0.0, static_cast<double>(samples.size() - 1));
  const size_t index = std::min(static_cast<size_t>(place), samples.size() - 2);
  const Spring &a = samples[index], &b = samples[index + 1];
  const double u = place - static_cast<double>(index), v = 1 - u;
  return v * v * (1 + 2 * u) * a.angle + u * u * (1 + 2 * v) * b.angle +
         u * v * kStep * (v * a.rate - u * b.rate);
}

double Suspension::Pitch(double time) const { return At(pitch_, time); }
double Suspension::Roll(double time) const { return At(roll_, time); }

}  // namespace parkade::simulator
