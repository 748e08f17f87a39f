#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <random>

#include "core/error.h"
#include "server/ingest/checks/log_checks.h"
#include "server/ingest/checks/wheel_checks.h"

namespace parkade {
namespace {

constexpr Timestamp kBegin{1'700'000'000'000'000'000};
const CheckedTopics kTopics = {"/imu", "/odom", "/fix", {}};

/// A car that drives 20 s of curves, and what was done to its samples.
struct Drive {
  std::function<void(ImuSample&, int)> alter_imu = [](ImuSample&, int) {};
  std::function<void(WheelSample&)> alter_wheels = [](WheelSample&) {};
  std::function<void(GnssFix&)> alter_fix = [](GnssFix&) {};
  bool has_wheels = true, has_vehicle = true;
  double gyroscope_noise = 1e-3;  ///< [rad/s/sqrt(Hz)], by the rig
};

std::vector<Finding> Check(const Drive& drive) {
  Rig rig;
  rig.imu.gyroscope_noise_density = drive.gyroscope_noise;
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
    const Timestamp time = kBegin + 0.005 * i;
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
  EXPECT_EQ(NamesOf(scaled(1e-3)), "imu_scale");
  EXPECT_EQ(NamesOf(scaled(2.3)), "imu_scale");
  EXPECT_EQ(NamesOf(scaled(1.1)), "imu_gain");
  EXPECT_EQ(NamesOf(scaled(1.02)), "");
  const Finding finding = scaled(1 / 9.81).front();
  EXPECT_EQ(finding.severity, Severity::kUnusable);
  EXPECT_NE(ToText(finding).find("the IMU /imu reads accelerations in g"), std::string::npos);
  EXPECT_NE(ToText(finding).find("accelerometer_scale: 9.80665"), std::string::npos);
  EXPECT_THROW(RequireUsable({finding}), Error);
}

TEST(LogChecks, TakeWhatPushesACarForNoGain) {
  const std::vector<Finding> findings = CheckImu([](ImuSample& sample, int i) {
    sample.linear_acceleration.x() += i / 100 % 2 == 0 ? 4.5 : -4.5;  // 10.8 m/s2 in all
  });

  EXPECT_EQ(NamesOf(findings).find("imu_gain"), std::string::npos);
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

TEST(LogChecks, SayHowFarTheCarWentWithoutRates) {
  const auto without_rates = [](ImuSample& sample, int) { sample.angular_velocity.setZero(); };
  EXPECT_NEAR(CheckImu(without_rates).at(0).evidence.at(kWay), 60, 1);
  EXPECT_EQ(Check({.alter_imu = without_rates, .has_wheels = false}).at(0).evidence.at(kWay), 0);
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
  EXPECT_EQ(NamesOf(CheckImu([](ImuSample& sample, int) {
              sample.angular_velocity.z() = std::clamp(sample.angular_velocity.z(), -0.1, 0.1);
            })),
            "imu_saturated");
}

TEST(LogChecks, KnowAnAxisThatReadsNothing) {
  const auto dead = [](Eigen::Vector3d ImuSample::*sensor, Eigen::Index axis) {
    return NamesOf(CheckImu([=](ImuSample& sample, int) { (sample.*sensor)[axis] = 0; }));
  };
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    EXPECT_NE(dead(&ImuSample::angular_velocity, axis).find("imu_axis_dead"), std::string::npos);
    EXPECT_NE(dead(&ImuSample::linear_acceleration, axis).find("imu_axis_dead"), std::string::npos);
  }
}

TEST(LogChecks, LetAnAxisReadTheSameAtRest) {
  const std::vector<Finding> findings = Check({.alter_imu =
                                                   [](ImuSample& sample, int) {
                                                     sample.angular_velocity *= 0.1;
                                                     sample.angular_velocity.y() = 0;
                                                   },
                                               .has_wheels = false});
  EXPECT_EQ(NamesOf(findings), "");
}

TEST(LogChecks, KnowReadingsThatADriverRepeats) {
  const auto stuck_from = [](int first, int last, double speed) {
    auto kept = std::make_shared<ImuSample>();
    return Check({.alter_imu =
                      [=](ImuSample& sample, int i) {
                        if (i == first) *kept = sample;
                        if (i < first || i >= last) return;
                        sample.angular_velocity = kept->angular_velocity;
                        sample.linear_acceleration = kept->linear_acceleration;
                      },
                  .alter_wheels =
                      [=](WheelSample& wheels) {
                        if (wheels.time - kBegin >= 0.005 * first) wheels.forward_speed = speed;
                      }});
  };
  EXPECT_EQ(NamesOf(stuck_from(2000, 4000, 3)), kImuStuck);
  EXPECT_EQ(NamesOf(stuck_from(2000, 2400, 3)), kImuStuck);
  EXPECT_EQ(NamesOf(stuck_from(2000, 2050, 3)), "") << "a quarter of a second";
  EXPECT_EQ(NamesOf(stuck_from(2000, 4000, 0)), "") << "a car at rest";
}

TEST(LogChecks, KnowAnImuThatIsSlowOrComesInPackets) {
  const auto with_stamps = [](const std::function<double(int)>& stamp_of, int every) {
    Rig rig;
    rig.vehicle.emplace();
    LogChecks checks(rig);
    for (int i = 0; i < 2000; i += every)
      checks.Include(ImuSample{kBegin + stamp_of(i),
                               {0.001 * (i % 7), 0.002 * (i % 5), 0.1},
                               {0.01 * (i % 3), 0.01 * (i % 11), 9.81}});
    return NamesOf(checks.Findings(kTopics));
  };
  const auto even = [](int i) { return 0.01 * i; };
  EXPECT_EQ(with_stamps(even, 1).find("imu_"), std::string::npos);
  EXPECT_EQ(with_stamps(even, 5).find("imu_"), std::string::npos);
  EXPECT_NE(with_stamps(even, 8).find("imu_slow"), std::string::npos);
  const auto in_packets = [](int i) { return 0.2 * (i / 20) + 1e-5 * (i % 20); };
  EXPECT_NE(with_stamps(in_packets, 1).find("imu_in_packets"), std::string::npos);
}

TEST(LogChecks, KnowNoisesThatNoImuHas) {
  EXPECT_EQ(NamesOf(Check({.gyroscope_noise = 1e-9})), "imu_noise_too_small");
  EXPECT_EQ(NamesOf(Check({.gyroscope_noise = 2e-6})), "");
}

TEST(LogChecks, MeasureHowLateWheelsAre) {
  for (const double delay : {0.05, 0.35, -0.2}) {
    const std::vector<Finding> findings =
        Check({.alter_wheels = [=](WheelSample& wheels) { wheels.time = wheels.time + delay; }});
    ASSERT_EQ(NamesOf(findings), kWheelsLate) << delay;
    EXPECT_NEAR(findings[0].evidence.at(kDelay), delay, 0.01);
  }
}

TEST(LogChecks, KnowWheelsOfTheDashboard) {
  EXPECT_EQ(NamesOf(Check({.alter_wheels =
                               [](WheelSample& wheels) {
                                 const double seconds = wheels.time - kBegin;
                                 wheels.forward_speed = 0.5 * std::floor(seconds / 2);
                               }})),
            kWheelsAreCoarse);
}

TEST(LogChecks, KnowWheelsThatAreBlindToSlowness) {
  const auto below = [](double least) {
    return NamesOf(Check({.alter_wheels = [least](WheelSample& wheels) {
      const double speed = 3 * std::max(0.0, std::sin(0.8 * (wheels.time - kBegin)));
      wheels.forward_speed = speed < least ? 0 : speed;
    }}));
  };
  EXPECT_EQ(below(0.5), kWheelsAreBlind);
  EXPECT_EQ(below(2), kWheelsAreBlind);
  EXPECT_EQ(below(0.05), "");
  EXPECT_EQ(NamesOf(Check({.alter_wheels =
                               [](WheelSample& wheels) {
                                 const double seconds = wheels.time - kBegin;
                                 if (seconds > 5 && seconds < 6) wheels.forward_speed = 0;
                                 if (seconds < 3) wheels.forward_speed = 1 + 0.5 * seconds;
                               }})),
            "")
      << "a second without wheels is something else";
}

TEST(LogChecks, LetWheelsOfTenHertzStart) {
  const auto starting = [](double least) {
    SpeedHistory wheels;
    for (int i = 0; i < 300; ++i) {
      const double speed = std::clamp(0.21 * (i - 50), 0.0, 4.0);
      wheels.Include({kBegin + 0.1 * i, speed < least ? 0 : speed + 1e-3 * (i % 7), 0});
    }
    return CheckSpeeds(wheels, "/odom");
  };
  EXPECT_FALSE(starting(0.01)) << starting(0.01)->sentence;
  EXPECT_TRUE(starting(1));
}

TEST(LogChecks, KnowAccelerationsThatChangeTheirUnit) {
  const auto from = [](int first, double scale) {
    return NamesOf(CheckImu([=](ImuSample& sample, int i) {
      if (i >= first) sample.linear_acceleration *= scale;
    }));
  };
  for (const int first : {600, 2000, 3400}) {
    EXPECT_EQ(from(first, 1 / 9.81), "imu_changes") << first;
    EXPECT_EQ(from(first, 1.5), "imu_changes") << first;
  }
  EXPECT_EQ(from(2000, 1.03), "");
  EXPECT_EQ(from(0, 1 / 9.81), "imu_in_g");
}

TEST(LogChecks, KnowWheelsThatStick) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.01);
  double speed = 0;
  const auto from = [&](double seconds, double shown) {
    return NamesOf(Check({.alter_wheels = [&, seconds, shown](WheelSample& sample) {
      if (sample.time - kBegin < seconds) {
        speed = sample.forward_speed + noise(random);
        sample.forward_speed = speed;
      } else {
        sample.forward_speed = shown < 0 ? speed : shown;
        sample.yaw_rate = 0.1;
      }
    }}));
  };
  EXPECT_EQ(from(100, 0).find(kWheelsStick), std::string::npos);
  EXPECT_NE(from(15, -1).find(kWheelsStick), std::string::npos);
  EXPECT_EQ(from(15, 0).find(kWheelsStick), std::string::npos) << "a car may stand";
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

TEST(ImuChecks, LeaveTheMountingToCamerasOnlyWhereTheyTellOfTurns) {
  Rig rig;
  rig.vehicle.emplace();
  ImuChecks checks(rig);
  SpeedHistory wheels, cameras("the cameras", 0.1), blind_cameras("the cameras", 0.1);
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 0.01);
  const auto noisy = [&](double x, double y, double z) {
    return Eigen::Vector3d(x + noise(random), y + noise(random), z + noise(random));
  };
  for (int i = 0; i < 4000; ++i) {
    const Timestamp time = kBegin + 0.005 * i;
    const double yaw_rate = 0.5 * std::sin(0.0025 * i), speed = 3;
    // A quarter turn off.
    checks.Include({time, noisy(0, 0, yaw_rate), noisy(speed * yaw_rate, 0, 9.81)});
    if (i % 20 != 0) continue;
    wheels.Include({time, speed, yaw_rate});
    cameras.Include({time, speed, yaw_rate});
    blind_cameras.Include({time, speed, 0});
  }

  EXPECT_EQ(NamesOf(checks.Findings("/imu", wheels)), "imu_mounting");
  EXPECT_EQ(NamesOf(checks.Findings("/imu", cameras)), "imu_mounting");
  EXPECT_EQ(NamesOf(checks.Findings("/imu", blind_cameras)), "");
}

}  // namespace
}  // namespace parkade
