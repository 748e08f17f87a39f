#include "tests/simulator/sensors/imu_sensor.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/simulator/vehicle/simulated_rig.h"

namespace parkade::simulator {
namespace {

constexpr double kRate = 10;  // [Hz]
constexpr size_t kNumSamples = 3'000'000;

/// The deviation of the means of clusters of `size` values.
double AllanDeviation(const std::vector<float>& values, size_t size) {
  std::vector<double> means;
  for (size_t i = 0; i + size <= values.size(); i += size) {
    double sum = 0;
    for (size_t k = i; k < i + size; ++k) sum += values[k];
    means.push_back(sum / static_cast<double>(size));
  }
  double sum = 0;
  for (size_t i = 1; i < means.size(); ++i)
    sum += (means[i] - means[i - 1]) * (means[i] - means[i - 1]);
  return std::sqrt(sum / (2 * static_cast<double>(means.size() - 1)));
}

/// White noise and a Gauss-Markov bias that is driven by noise of density `walk`: IEEE Std
/// 952-1997, annex C.
double ExpectedAllanDeviation(double density, double walk, double seconds) {
  constexpr double kTime = 3600;
  const double x = seconds / kTime;
  const double bias = walk * walk * kTime * kTime / seconds *
                      (1 - (3 - 4 * std::exp(-x) + std::exp(-2 * x)) / (2 * x));
  return std::sqrt(density * density / seconds + bias);
}

struct Recording {
  std::vector<float> gyroscope, accelerometer;
};

/// The errors of an IMU that feels nothing, for more than three days.
Recording RecordStanding(const ImuGrade& grade) {
  ImuErrors errors(grade, kRate, 1, 77);
  Recording recording;
  for (size_t i = 0; i < kNumSamples; ++i) {
    const ImuSample sample = errors.Apply({{}, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
    recording.gyroscope.push_back(static_cast<float>(sample.angular_velocity.x()));
    recording.accelerometer.push_back(static_cast<float>(sample.linear_acceleration.y()));
  }
  return recording;
}

class ImuGrades : public testing::TestWithParam<const char*> {};

TEST_P(ImuGrades, AllanDeviationIsThatOfTheDensitiesInTheRigFile) {
  const ImuGrade& grade = ImuGradeNamed(GetParam());
  const ImuCalibration told = CalibrationOf(grade, kRate, "imu");
  const Recording recording = RecordStanding(grade);

  for (const size_t size : {size_t{1}, size_t{10}, size_t{100}, size_t{1000}, size_t{8000}}) {
    const double seconds = static_cast<double>(size) / kRate;
    const double gyroscope =
        ExpectedAllanDeviation(told.gyroscope_noise_density, told.gyroscope_random_walk, seconds);
    const double accelerometer = ExpectedAllanDeviation(told.accelerometer_noise_density,
                                                        told.accelerometer_random_walk, seconds);
    EXPECT_NEAR(AllanDeviation(recording.gyroscope, size) / gyroscope, 1, 0.1) << seconds;
    EXPECT_NEAR(AllanDeviation(recording.accelerometer, size) / accelerometer, 1, 0.1) << seconds;
  }
}

TEST_P(ImuGrades, AllanDeviationFallsWithTheRootOfTimeAndRisesWithItLater) {
  const Recording recording = RecordStanding(ImuGradeNamed(GetParam()));
  const auto slope = [&](size_t from, size_t to) {
    const double ratio =
        AllanDeviation(recording.accelerometer, to) / AllanDeviation(recording.accelerometer, from);
    return std::log(ratio) / std::log(static_cast<double>(to) / static_cast<double>(from));
  };

  EXPECT_NEAR(slope(1, 10), -0.5, 0.03);
  EXPECT_NEAR(slope(1500, 6000), 0.5, 0.1);
}

INSTANTIATE_TEST_SUITE_P(Grades, ImuGrades, testing::Values("mems", "rt3000"));

Motion Standing(double duration) {
  return Motion([](double) { return PoseVector(PoseVector::Zero()); }, duration);
}

TEST(SimulateImu, WithoutNoiseAStandingImuFeelsGravityOnly) {
  SensorOptions options;
  options.imu_noise = 0;
  const Rig rig = MakeSimulatedRig({}, 1);
  const auto samples = SimulateImu(Standing(1), rig, options, 1);

  ASSERT_EQ(samples.size(), 100u);
  EXPECT_NEAR(samples[50].linear_acceleration.norm(), kGravity, 1e-9);
  EXPECT_NEAR((rig.body_from_imu.rotation * samples[50].linear_acceleration).z(), kGravity, 1e-9);
  EXPECT_NEAR(samples[50].angular_velocity.norm(), 0, 1e-12);
}

TEST(SimulateImu, AnRt3000ErrsLessThanAMemsImu) {
  const Rig rig = MakeSimulatedRig({}, 1);
  const auto worst_error = [&](const char* grade) {
    SensorOptions options;
    options.imu = grade;
    double worst = 0;
    for (const ImuSample& sample : SimulateImu(Standing(20), rig, options, 3))
      worst = std::max(worst, std::abs(sample.linear_acceleration.norm() - kGravity));
    return worst;
  };

  EXPECT_LT(5 * worst_error("rt3000"), worst_error("mems"));
}

TEST(SimulateImu, ComesAtTheRateAskedFor) {
  SensorOptions options;
  options.imu_rate = 200;
  EXPECT_EQ(SimulateImu(Standing(2), MakeSimulatedRig({}, 1), options, 1).size(), 400u);
}

TEST(SensorOptions, UnknownKindsAreRefused) {
  SensorOptions options;
  options.gnss = "galileo";
  EXPECT_THROW(options.Validate(), Error);
  options = {};
  options.imu = "gyroscope";
  EXPECT_THROW(options.Validate(), Error);
}

}  // namespace
}  // namespace parkade::simulator
