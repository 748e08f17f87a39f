#include "tests/simulator/scenes/sky.h"

#include <algorithm>
#include <cmath>

#include "tests/simulator/common/noise.h"
#include "tests/simulator/common/random.h"

namespace parkade::simulator {
namespace {

constexpr int kColumns = 1024, kRows = 256;

/// Angle-like coordinate of azimuth, 0..1, cheaper than atan2 and one-to-one.
float DiamondAzimuth(float x, float y) {
  const float sum = std::abs(x) + std::abs(y);
  if (sum == 0) return 0;
  const float ratio = y / sum;
  const float quarter = x >= 0 ? ratio : 2 - ratio;  // -1..3
  return 0.25f * (quarter + 1);
}

Eigen::Vector2f FromDiamondAzimuth(float azimuth) {
  const float quarter = 4 * azimuth - 1;
  const float y = quarter <= 1 ? quarter : 2 - quarter;
  const float x = (quarter <= 1 ? 1.0f : -1.0f) * (1 - std::abs(y));
  return Eigen::Vector2f(x, y).normalized();
}

}  // namespace

void Sky::ChooseLight(Weather weather) {
  sun_irradiance_ = 2.6f * Rgb(1.0f, 0.94f, 0.83f);
  haze_ = Rgb(0.46f, 0.50f, 0.56f);
  zenith_ = Rgb(0.16f, 0.25f, 0.44f);
  from_above_ = 3.14f * Rgb(0.30f, 0.35f, 0.44f);
  from_below_ = 3.14f * Rgb(0.13f, 0.13f, 0.12f);
  glow_ = Rgb(1.0f, 0.95f, 0.85f);
  if (weather == Weather::kOvercast || weather == Weather::kWet) {
    const float dim = weather == Weather::kWet ? 0.6f : 0.85f;
    sun_irradiance_ = glow_ = Gray(0);
    haze_ = dim * Rgb(0.44f, 0.46f, 0.48f);
    zenith_ = dim * Rgb(0.58f, 0.60f, 0.63f);
    from_above_ = 3.14f * dim * Rgb(0.53f, 0.55f, 0.57f);
    from_below_ = 3.14f * dim * Rgb(0.09f, 0.09f, 0.09f);
    cloud_ = 0.36f * dim;
    overcast_ = 1;
  } else if (weather == Weather::kDusk) {
    sun_irradiance_ = Gray(0);
    haze_ = Rgb(0.040f, 0.030f, 0.032f);
    zenith_ = Rgb(0.008f, 0.012f, 0.026f);
    from_above_ = 3.14f * Rgb(0.012f, 0.014f, 0.021f);
    from_below_ = 3.14f * Rgb(0.006f, 0.005f, 0.004f);
    glow_ = Rgb(0.06f, 0.03f, 0.012f);
    cloud_ = 0.012f;
  }
}

Sky::Sky(std::uint64_t seed, Weather weather, double elevation_deg) {
  Random random(seed, 0x5c1);
  const double usual = random.Uniform(0.55, 0.95), azimuth = random.Uniform(0, 2 * M_PI);
  const double elevation = elevation_deg > 0 ? elevation_deg * M_PI / 180 : usual;
  sun_direction_ = Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth),
                                   std::cos(elevation) * std::sin(azimuth), std::sin(elevation))
                       .cast<float>();
  ChooseLight(weather);

  map_.resize(kColumns * kRows);
  for (int row = 0; row < kRows; ++row) {
    const float z = (static_cast<float>(row) + 0.5f) / kRows;
    for (int column = 0; column < kColumns; ++column) {
      const Eigen::Vector2f flat =
          FromDiamondAzimuth((static_cast<float>(column) + 0.5f) / kColumns) * std::sqrt(1 - z * z);
      map_[static_cast<size_t>(row * kColumns + column)] = Paint(
          Eigen::Vector3f(flat.x(), flat.y(), z), static_cast<std::uint32_t>(Mix64(seed ^ 0xc10d)));
    }
  }
}

Color Sky::Paint(const Eigen::Vector3f& direction, std::uint32_t seed) const {
  const float z = direction.z();
  Color color = haze_ + (zenith_ - haze_) * std::pow(z, 0.55f);
  // Clouds on a plane far up; they melt into the haze toward the horizon.
  const float x = direction.x() / (z + 0.12f), y = direction.y() / (z + 0.12f);
  const float density = SmoothStep(0.02f, 0.5f, FractalNoise(1.3f * x, 1.3f * y, 5, seed));
  const float toward_sun = std::max(0.0f, direction.dot(sun_direction_));
  const Color cloud = Gray(cloud_ * (1 + 0.4f * (1 - overcast_) * std::pow(toward_sun, 8.0f)));
  color += (cloud - color) * (0.75f * density * SmoothStep(0.02f, 0.3f, z));
  return color +
         glow_ * (0.25f * std::pow(toward_sun, 24.0f) + 1.2f * std::pow(toward_sun, 400.0f));
}

Color Sky::Radiance(const Eigen::Vector3f& direction) const {
  if (direction.z() <= 0) return haze_ * std::max(0.35f, 1 + 2 * direction.z());
  if (sun_irradiance_[0] > 0 && direction.dot(sun_direction_) > 1 - 4 * kSunRadius * kSunRadius)
    return Rgb(60, 58, 52);
  const float u = DiamondAzimuth(direction.x(), direction.y()) * kColumns - 0.5f;
  const float v = std::clamp(direction.z() * kRows - 0.5f, 0.0f, kRows - 1.001f);
  const int left = FastFloorToInt(u), low = static_cast<int>(v);
  const float fu = u - static_cast<float>(left), fv = v - static_cast<float>(low);
  const auto at = [&](int column, int row) -> const Color& {
    return map_[static_cast<size_t>(row * kColumns + ((column + kColumns) & (kColumns - 1)))];
  };
  return (at(left, low) * (1 - fu) + at(left + 1, low) * fu) * (1 - fv) +
         (at(left, low + 1) * (1 - fu) + at(left + 1, low + 1) * fu) * fv;
}

Color Sky::AmbientIrradiance(const Eigen::Vector3f& normal) const {
  const float up = 0.5f + 0.5f * normal.z();
  return from_above_ * up + from_below_ * (1 - up);
}

}  // namespace parkade::simulator
