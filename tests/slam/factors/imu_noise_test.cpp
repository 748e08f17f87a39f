#include "slam/factors/imu_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "slam/factors/imu_preintegration.h"

namespace parkade {
namespace {

constexpr double kRate = 200;  // [Hz]

ImuCalibration Declared() {
  ImuCalibration declared;
  declared.update_rate = kRate;
  declared.accelerometer_noise_density = 2e-3;
  declared.gyroscope_noise_density = 2e-4;
  return declared;
}

/// `seconds` of white noise, `factor` times the declared, on top of a motion at 2 Hz.
std::vector<ImuSample> Samples(double factor, double seconds) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, factor * std::sqrt(kRate));
  const auto noise = [&](double density) {
    const double x = normal(random), y = normal(random), z = normal(random);
    return Eigen::Vector3d(density * Eigen::Vector3d(x, y, z));
  };
  std::vector<ImuSample> samples;
  for (int k = 0; k <= seconds * kRate; ++k) {
    const double wave = std::sin(2 * M_PI * 2 * k / kRate);
    samples.push_back({TimestampFromSeconds(100 + k / kRate),
                       Eigen::Vector3d(0, 0, 0.3 * wave) + noise(2e-4),
                       Eigen::Vector3d(wave, 0, 9.81) + noise(2e-3)});
  }
  return samples;
}

TEST(WithMeasuredNoise, BelievesADatasheetThatFits) {
  for (const double factor : {0.0, 1.0}) {
    const ImuCalibration found = WithMeasuredNoise(Declared(), Samples(factor, 0.2));

    EXPECT_NEAR(found.accelerometer_noise_density, 2e-3, 1e-5) << factor;
    EXPECT_NEAR(found.gyroscope_noise_density, 2e-4, 1e-6) << factor;
  }
}

TEST(WithMeasuredNoise, FindsTenTimesTheDeclaredNoise) {
  const ImuCalibration found = WithMeasuredNoise(Declared(), Samples(10, 1));

  EXPECT_NEAR(found.accelerometer_noise_density, 2e-2, 3e-3);
  EXPECT_NEAR(found.gyroscope_noise_density, 2e-3, 3e-4);
}

TEST(WithMeasuredNoise, AVibrationAtOneFrequencyIsNoWhiteNoise) {
  std::vector<ImuSample> samples = Samples(1, 1);
  for (size_t k = 0; k < samples.size(); ++k)
    samples[k].linear_acceleration.x() += k % 2 == 0 ? 3 : -3;  // 100 Hz

  EXPECT_LT(WithMeasuredNoise(Declared(), samples).accelerometer_noise_density, 3e-3);
}

TEST(WithMeasuredNoise, AFewSamplesTellNothing) {
  EXPECT_EQ(WithMeasuredNoise(Declared(), Samples(100, 0.02)).accelerometer_noise_density, 2e-3);
}

TEST(WithMeasuredNoise, WidensWhatIsIntegrated) {
  const ImuPreintegration quiet(Samples(1, 0.5), {}, Declared()),
      loud(Samples(10, 0.5), {}, Declared());

  EXPECT_NEAR(std::sqrt(loud.covariance()(3, 3) / quiet.covariance()(3, 3)), 10, 2);
}

}  // namespace
}  // namespace parkade
