#include "tests/simulator/motion/terrain.h"

#include <cmath>

#include "tests/simulator/common/random.h"

namespace parkade::simulator {

Terrain::Terrain(std::uint64_t seed, double relief) {
  Random random(seed, 0x7e44);
  slope_ = relief * Eigen::Vector2d(random.Uniform(-0.012, 0.012), random.Uniform(-0.015, 0.015));
  for (Wave& wave : waves_) {
    const double wavelength = random.Uniform(17, 42), direction = random.Uniform(0, 2 * M_PI);
    wave.wave_vector =
        2 * M_PI / wavelength * Eigen::Vector2d(std::cos(direction), std::sin(direction));
    wave.amplitude = relief * random.Uniform(0.0015, 0.0028) * wavelength;
    wave.phase = random.Uniform(0, 2 * M_PI);
  }
}

double Terrain::Height(double x, double y) const {
  const Eigen::Vector2d point(x, y);
  double height = slope_.dot(point);
  for (const Wave& wave : waves_)
    height += wave.amplitude * std::sin(wave.wave_vector.dot(point) + wave.phase);
  return height;
}

Eigen::Vector2d Terrain::Gradient(double x, double y) const {
  const Eigen::Vector2d point(x, y);
  Eigen::Vector2d gradient = slope_;
  for (const Wave& wave : waves_)
    gradient +=
        wave.amplitude * std::cos(wave.wave_vector.dot(point) + wave.phase) * wave.wave_vector;
  return gradient;
}

Eigen::Vector3d Terrain::Normal(double x, double y) const {
  const Eigen::Vector2d gradient = Gradient(x, y);
  return Eigen::Vector3d(-gradient.x(), -gradient.y(), 1).normalized();
}

}  // namespace parkade::simulator
