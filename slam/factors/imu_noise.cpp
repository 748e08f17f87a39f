#include "slam/factors/imu_noise.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace parkade {
namespace {

constexpr size_t kMeans[] = {1, 2, 4};  // samples
constexpr size_t kMinDifferences = 3;   // of three axes each
constexpr double kChance = 1.5;         // times the declared density
constexpr double kMaxSamplePeriods = 4;

/// [unit/sqrt(Hz)] of the quietest band; 0 where there are too few samples.
double QuietestDensity(const std::vector<Eigen::Vector3d>& values, double period) {
  double quietest = std::numeric_limits<double>::infinity();
  for (const size_t mean : kMeans) {
    if (values.size() < 3 * mean + kMinDifferences - 1) break;
    const size_t num_differences = values.size() - 3 * mean + 1;
    double squared = 0;
    for (size_t i = 0; i < num_differences; ++i) {
      Eigen::Vector3d difference = Eigen::Vector3d::Zero();
      for (size_t k = i; k < i + mean; ++k)
        difference += values[k] - 2 * values[k + mean] + values[k + 2 * mean];
      squared += difference.squaredNorm();
    }
    const auto count = static_cast<double>(3 * num_differences * 6 * mean);
    quietest = std::min(quietest, std::sqrt(squared / count * period));
  }
  return std::isfinite(quietest) ? quietest : 0;
}

double Raised(double declared, double measured) {
  return std::sqrt(declared * declared +
                   std::max(0.0, measured * measured - std::pow(kChance * declared, 2)));
}

}  // namespace

ImuCalibration WithMeasuredNoise(const ImuCalibration& declared,
                                 std::span<const ImuSample> samples) {
  ImuCalibration raised = declared;
  if (samples.size() < 4) return raised;
  // The first and the last may be interpolated.
  const std::span<const ImuSample> inner = samples.subspan(1, samples.size() - 2);
  std::vector<Eigen::Vector3d> rates, forces;
  for (size_t i = 0; i < inner.size(); ++i) {
    if (i > 0 && (inner[i].time - inner[i - 1].time) * declared.update_rate > kMaxSamplePeriods)
      return raised;
    rates.push_back(inner[i].angular_velocity);
    forces.push_back(inner[i].linear_acceleration);
  }
  const double period =
      (inner.back().time - inner.front().time) / static_cast<double>(inner.size() - 1);
  raised.gyroscope_noise_density =
      Raised(declared.gyroscope_noise_density, QuietestDensity(rates, period));
  raised.accelerometer_noise_density =
      Raised(declared.accelerometer_noise_density, QuietestDensity(forces, period));
  return raised;
}

}  // namespace parkade
