#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "core/error.h"
#include "server/ingest/checks/log_checks.h"

namespace parkade {
namespace {

const CheckedTopics kTopics = {"/imu", "/odom", "/fix", {}};

/// A car that drives 20 s of curves, and what was done to its samples.
struct Drive {
  std::function<void(ImuSample&, int)> alter_imu = [](ImuSample&, int) {};
  std::function<void(WheelSample&)> alter_wheels = [](WheelSample&) {};
  std::function<void(GnssFix&)> alter_fix = [](GnssFix&) {};
  bool has_wheels = true, has_vehicle = true;
};

std::vector<Finding> Check(const Drive& drive) {
  Rig rig;
  rig.body_from_imu.rotation = ExpSo3({0, 0, 0.3});
  if (drive.has_vehicle) rig.vehicle.emplace();
  LogChecks checks(rig);
  std::mt19937 random(7);
  std::normal_distribution<double> noise;
  const auto noisy = [&](const Eigen::Vector3d& value, double sigma) {
    return Eigen::Vector3d(value +
                           sigma * Eigen::Vector3d(noise(random), noise(random), noise(random)));
  };
  for (int i = 0; i < 4000; ++i) {
    const Timestamp time = Timestamp{1'700'000'000'000'000'000} + 0.005 * i;
    const double yaw_rate = 0.5 * std::sin(0.0025 * i), speed = 3;
    const Eigen::Quaterniond imu_from_body = rig.body_from_imu.rotation.conjugate();
    ImuSample sample{time, noisy(imu_from_body * Eigen::Vector3d(0, 0, yaw_rate), 0.01),
                     noisy(imu_from_body * Eigen::Vector3d(0, speed * yaw_rate, 9.81), 0.1)};
    drive.alter_imu(sample, i);
    checks.Include(sample);
    if (i % 4 == 0 && drive.has_wheels) {
      WheelSample wheels{time, speed, yaw_rate};
      drive.alter_wheels(wheels);
      checks.Include(wheels);
    }
    if (i % 40 == 0) {
      GnssFix fix{time, 48.1 + 1e-7 * i, 11.5, 500};
      drive.alter_fix(fix);
      checks.Include(fix);
    }
  }
  return checks.Findings(kTopics);
}

/// The names of the findings, and the texts of all.
std::string NamesOf(const std::vector<Finding>& findings) {
  std::string names;
  for (const Finding& finding : findings) names += (names.empty() ? "" : " ") + finding.name;
  return names;
}

std::vector<Finding> CheckImu(const std::function<void(ImuSample&, int)>& alter) {
  return Check({.alter_imu = alter});
}

TEST(LogChecks, SayNothingAboutAGoodDrive) {
  EXPECT_EQ(NamesOf(Check({})), "");
  EXPECT_EQ(NamesOf(Check({.has_wheels = false})), "");
  EXPECT_EQ(NamesOf(Check({.has_vehicle = false})), "");
}

TEST(LogChecks, KnowUnitsOfAccelerations) {
  const auto scaled = [](double scale) {
    return CheckImu([=](ImuSample& sample, int) { sample.linear_acceleration *= scale; });
  };
  EXPECT_EQ(NamesOf(scaled(1 / 9.81)), "imu_in_g");
  EXPECT_EQ(NamesOf(scaled(1000 / 9.81)), "imu_in_mg");
  EXPECT_EQ(NamesOf(scaled(1e-3)), "imu_without_gravity");
  EXPECT_EQ(NamesOf(scaled(2.3)), "imu_scale");
  EXPECT_EQ(NamesOf(scaled(1.1)), "imu_gain");
  EXPECT_EQ(NamesOf(scaled(1.02)), "");
  const Finding finding = scaled(1 / 9.81).front();
  EXPECT_EQ(finding.severity, Severity::kUnusable);
  EXPECT_NE(ToText(finding).find("the IMU /imu reads accelerations in g"), std::string::npos);
  EXPECT_NE(ToText(finding).find("accelerometer_scale: 9.80665"), std::string::npos);
  EXPECT_THROW(RequireUsable({finding}), Error);
}

TEST(LogChecks, KnowAccelerationsWithoutGravity) {
  EXPECT_EQ(
      NamesOf(CheckImu([](ImuSample& sample, int) { sample.linear_acceleration.z() -= 9.81; })),
      "imu_without_gravity");
}

TEST(LogChecks, KnowHalvesOfAnImu) {
  const auto without = [](Eigen::Vector3d ImuSample::*half, int every) {
    return NamesOf(CheckImu([=](ImuSample& sample, int i) {
      if (i % every == 0) (sample.*half).setZero();
    }));
  };
  EXPECT_EQ(without(&ImuSample::angular_velocity, 1), "imu_without_rates");
  EXPECT_EQ(without(&ImuSample::linear_acceleration, 1), "imu_without_accelerations");
  EXPECT_EQ(without(&ImuSample::angular_velocity, 2), "imu_in_halves");
  EXPECT_EQ(without(&ImuSample::linear_acceleration, 2), "imu_in_halves");
}

TEST(LogChecks, KnowRatesInDegrees) {
  const auto in_degrees = [](ImuSample& sample, int) {
    sample.angular_velocity *= 180 / std::numbers::pi;
  };
  EXPECT_EQ(NamesOf(Check({.alter_imu = in_degrees})), "imu_in_degrees");
  EXPECT_EQ(NamesOf(Check({.alter_imu = in_degrees, .has_wheels = false})), "imu_in_degrees");
  EXPECT_EQ(NamesOf(CheckImu([](ImuSample& sample, int) { sample.angular_velocity *= 1e-3; })),
            "gyroscope_scale");
  const auto wheels_in_degrees = [](WheelSample& wheels) { wheels.yaw_rate *= 57.3; };
  EXPECT_EQ(NamesOf(Check({.alter_wheels = wheels_in_degrees})), "") << "they are not used";
}

TEST(LogChecks, KnowAnImuThatIsMountedOtherwise) {
  const auto turned = [](const Eigen::Vector3d& turn) {
    return CheckImu([=](ImuSample& sample, int) {
      const Eigen::Quaterniond rotation = ExpSo3(turn);
      sample.angular_velocity = rotation * sample.angular_velocity;
      sample.linear_acceleration = rotation * sample.linear_acceleration;
    });
  };
  const std::vector<Finding> roof = turned({std::numbers::pi, 0, 0});
  EXPECT_EQ(NamesOf(roof), "imu_upside_down");
  EXPECT_NE(roof[0].sentence.find("is mounted upside down"), std::string::npos) << roof[0].sentence;
  const std::vector<Finding> sign =
      CheckImu([](ImuSample& sample, int) { sample.linear_acceleration *= -1; });
  EXPECT_EQ(NamesOf(sign), "imu_upside_down");
  EXPECT_NE(sign[0].sentence.find("wrong sign"), std::string::npos) << sign[0].sentence;
  EXPECT_EQ(NamesOf(turned({std::numbers::pi / 2, 0, 0})).substr(0, 12), "imu_mounting");
  EXPECT_EQ(NamesOf(turned({0.1, 0, 0})), "");
  EXPECT_EQ(NamesOf(turned({0, 0, std::numbers::pi / 2})), "imu_mounting");
  EXPECT_EQ(NamesOf(turned({0, 0, -std::numbers::pi / 2})), "imu_mounting");
  EXPECT_EQ(NamesOf(turned({0, 0, 0.3})), "");
}

TEST(LogChecks, KnowAxesThatAreNoRightHand) {
  EXPECT_EQ(NamesOf(CheckImu([](ImuSample& sample, int) { sample.angular_velocity.z() *= -1; })),
            "imu_left_handed");
  const auto swap_xy = [](Eigen::Vector3d& vector) { std::swap(vector.x(), vector.y()); };
  EXPECT_EQ(NamesOf(CheckImu([&](ImuSample& sample, int) {
              swap_xy(sample.angular_velocity);
              swap_xy(sample.linear_acceleration);
            })),
            "imu_mounting");
  // Wheels that go backward are another matter.
  EXPECT_EQ(
      NamesOf(Check({.alter_wheels = [](WheelSample& wheels) { wheels.forward_speed *= -1; }})),
      "");
}

TEST(LogChecks, KnowCoarseAndSaturatedReadings) {
  EXPECT_EQ(NamesOf(CheckImu([](ImuSample& sample, int) {
              sample.angular_velocity.z() = std::round(sample.angular_velocity.z() / 0.05) * 0.05;
            })),
            "imu_resolution");
  EXPECT_EQ(NamesOf(CheckImu([](ImuSample& sample, int) {
              sample.angular_velocity.z() = std::clamp(sample.angular_velocity.z(), -0.45, 0.45);
            })),
            "imu_saturated");
}

TEST(LogChecks, KnowWheelsThatNeverTurnAndFixesThatNeverMove) {
  EXPECT_EQ(NamesOf(Check({.alter_wheels =
                               [](WheelSample& wheels) {
                                 wheels = {wheels.time, 0, 0};
                               }})),
            kWheelsAreZero);
  EXPECT_EQ(NamesOf(Check({.alter_fix = [](GnssFix& fix) { fix.latitude_deg = 48.1; }})),
            kGnssIsFrozen);
}

}  // namespace
}  // namespace parkade
