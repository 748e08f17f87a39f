#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

namespace parkade {

/// What a lens and an exposure make of the light: an image's colors times At() are those of the
/// ground. Gain and falloff are of blue, green, red; a lens keeps exp(-(falloff[0] r^2 + falloff[1]
/// r^4)) of the light at r half diagonals off the image's middle.
class ExposureAndVignetting {
 public:
  using Falloff = std::array<Eigen::Array3f, 2>;

  ExposureAndVignetting() { factors_.fill({1, 1, 1}); }
  ExposureAndVignetting(const Eigen::Array3f& gain, const Falloff& falloff, int width, int height);

  /// Squared distance from the middle of an image of this size, in half diagonals.
  static float SquaredRadius(const Eigen::Vector2f& pixel, int width, int height) {
    const Eigen::Vector2f middle(0.5F * static_cast<float>(width - 1),
                                 0.5F * static_cast<float>(height - 1));
    return (pixel - middle).squaredNorm() / middle.squaredNorm();
  }

  /// The gains of blue, green and red at a pixel.
  const std::array<float, 3>& At(const Eigen::Vector2f& pixel) const {
    const float step = (pixel - middle_).squaredNorm() * steps_per_square_;
    if (!(step < static_cast<float>(kNumSteps - 1))) return factors_[kNumSteps - 1];
    // NOLINTNEXTLINE(bugprone-incorrect-roundings): never negative, and lround is a call
    return factors_[static_cast<std::size_t>(step + 0.5F)];
  }

 private:
  static constexpr std::size_t kNumSteps =
      129;  // of the squared radius: a step changes less than eight bits show

  Eigen::Vector2f middle_ = Eigen::Vector2f::Zero();
  float steps_per_square_ = 0;
  std::array<std::array<float, 3>, kNumSteps> factors_;
};

}  // namespace parkade
