#include "slam/refinement/sensor_agreement.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/slam/worlds/estimated_drive.h"

namespace parkade {
namespace {

/// A short drive of a rig that is a little off, without wheels.
SampledDrive Drive(std::uint32_t seed) {
  return MakeCarDrive({.seed = seed,
                       .duration = 12,
                       .start = 8,
                       .camera_rate = 5,
                       .num_cameras = 3,
                       .has_wheels = false,
                       .rig_rotation_deg = 0.3,
                       .rig_translation = 0.01});
}

SensorAgreement AgreementOf(const SampledDrive& drive) {
  return MeasureSensorAgreement(EstimateDrive(drive));
}

TEST(SensorAgreement, ASoundDriveIsWithinItsSigmas) {
  for (const std::uint32_t seed : {1u, 2u}) {
    const SensorAgreement agreement = AgreementOf(Drive(seed));
    EXPECT_GT(agreement.num_pairs, 40);
    EXPECT_LT(agreement.turn_gain_sigma, 0.003);
    EXPECT_LT(std::abs(agreement.turn_gain), 3 * agreement.turn_gain_sigma) << seed;
    EXPECT_LT(agreement.turn_delay_sigma, 0.01);
    EXPECT_LT(std::abs(agreement.turn_delay), 3 * agreement.turn_delay_sigma) << seed;
    EXPECT_EQ(agreement.leads.size(), 3u);
    for (const CameraLead& lead : agreement.leads)
      EXPECT_LT(std::abs(lead.ahead), 4 * lead.sigma) << seed << ' ' << lead.camera;
  }
}

TEST(SensorAgreement, AGainIsMeasured) {
  SampledDrive drive = Drive(4);
  for (ImuSample& sample : drive.imu) sample.angular_velocity *= 0.98;
  const SensorAgreement agreement = AgreementOf(drive);
  EXPECT_NEAR(agreement.turn_gain, -0.02, 0.005);
  EXPECT_LT(agreement.turn_gain, -5 * agreement.turn_gain_sigma);
}

TEST(SensorAgreement, LensesOfAnotherFocalLengthContradictTheGyroscope) {
  SampledDrive drive = Drive(5);
  for (TrackedFrame& frame : drive.frames)
    for (FeatureObservation& seen : frame.observations) {
      const double angle = std::acos(std::clamp(seen.bearing.z(), -1.0, 1.0)) / 1.05;
      const Eigen::Vector3d across =
          Eigen::Vector3d(seen.bearing.x(), seen.bearing.y(), 0).normalized();
      seen.bearing = std::sin(angle) * across + std::cos(angle) * Eigen::Vector3d::UnitZ();
    }
  const SensorAgreement agreement = AgreementOf(drive);
  EXPECT_GT(agreement.turn_gain, 0.02);
  EXPECT_GT(agreement.turn_gain, 5 * agreement.turn_gain_sigma);
}

TEST(SensorAgreement, ALowPassIsADelay) {
  SampledDrive drive = Drive(6);
  for (size_t i = 1; i < drive.imu.size(); ++i) {
    const Eigen::Vector3d last = drive.imu[i - 1].angular_velocity;
    drive.imu[i].angular_velocity = last + (drive.imu[i].angular_velocity - last) / 20;
  }
  const OdometryResult odometry = EstimateDrive(drive);
  const SensorAgreement agreement = MeasureSensorAgreement(odometry);
  // A part of it was taken for one of the cameras' stamps.
  double delay = agreement.turn_delay;
  for (const CameraCalibration& camera : odometry.report.calibration)
    for (const CalibratedQuantity& quantity : camera.quantities)
      if (quantity.name == "time_offset") delay += quantity.change[0] / 3;
  EXPECT_NEAR(delay, 19 / 200.0, 0.03) << "19 samples at 200 Hz";
}

TEST(SensorAgreement, ACameraThatSitsFartherBackIsFound) {
  SampledDrive drive = Drive(7);
  drive.rig.cameras[2].body_from_camera.translation.x() += 0.8;
  const SensorAgreement agreement = AgreementOf(drive);
  ASSERT_EQ(agreement.leads.size(), 3u);
  EXPECT_LT(agreement.leads[2].ahead, -0.4);
  EXPECT_LT(agreement.leads[2].ahead, -5 * agreement.leads[2].sigma);
}

TEST(SensorAgreement, ABodyThatIsNoPointOfTheRearAxleIsFound) {
  SampledDrive drive = Drive(9);
  const SensorAgreement sound = AgreementOf(drive);
  EXPECT_LT(sound.body_lead_sigma, 0.1);
  EXPECT_LT(std::abs(sound.body_lead), 0.1);
  // All that is mounted on the car lies a meter farther back in the rig than in the car.
  drive.rig.body_from_imu.translation.x() -= 1;
  for (RigCamera& camera : drive.rig.cameras) camera.body_from_camera.translation.x() -= 1;
  const SensorAgreement agreement = AgreementOf(drive);
  EXPECT_NEAR(agreement.body_lead, 1, 0.15);
}

TEST(SensorAgreement, NothingIsToldWithoutMeasurementsOrAVehicle) {
  const SampledDrive drive = Drive(8);
  OdometryResult odometry = EstimateDrive(drive);
  odometry.rig.vehicle.reset();
  EXPECT_EQ(MeasureSensorAgreement(odometry).num_pairs, 0);
  odometry.rig.vehicle = drive.rig.vehicle;
  odometry.measurements.reset();
  EXPECT_EQ(MeasureSensorAgreement(odometry).num_pairs, 0);
}

}  // namespace
}  // namespace parkade
