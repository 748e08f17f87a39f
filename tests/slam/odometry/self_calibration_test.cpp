// Cameras that are not where, or when, the rig says: thresholds are some two to three times what
// was measured over twelve seeds.
#include <gtest/gtest.h>

#include "slam/factors/fit_rotation.h"
#include "slam/odometry/calibrated_log.h"
#include "slam/odometry/gate_calibration.h"
#include "slam/smoother/drive_measurements.h"
#include "tests/slam/worlds/estimated_drive.h"

namespace parkade {
namespace {

SampledDriveOptions WrongRig(std::uint32_t seed, bool has_wheels) {
  SampledDriveOptions options;
  options.seed = seed;
  options.duration = 48;
  options.has_wheels = has_wheels;
  options.rig_rotation_deg = 1;
  options.rig_translation = 0.03;
  return options;
}

double RotationErrorDeg(const SampledDrive& drive, const Rig& rig, size_t camera) {
  return rig.ImuFromCamera(camera).rotation.angularDistance(
             drive.true_rig.ImuFromCamera(camera).rotation) *
         180 / M_PI;
}

/// [rad] in imu, of each camera.
std::vector<Eigen::Vector3d> TurnsOff(const SampledDrive& drive, const Rig& rig) {
  std::vector<Eigen::Vector3d> turns;
  for (size_t camera = 0; camera < rig.cameras.size(); ++camera)
    turns.push_back(LogSo3(rig.ImuFromCamera(camera).rotation *
                           drive.true_rig.ImuFromCamera(camera).rotation.conjugate()));
  return turns;
}

TEST(SelfCalibration, ADegreeAndThreeCentimetersOffDriftHardlyMoreThanTheExactRig) {
  constexpr double kDegree = M_PI / 180;
  for (const bool has_wheels : {true, false}) {
    const SampledDrive drive = MakeCarDrive(WrongRig(3, has_wheels));

    const EstimatedDrive estimated = EstimateAndCompare(drive);

    EXPECT_LT(estimated.error.drift_percent, 0.09) << has_wheels;
    const std::vector<Eigen::Vector3d> turns = TurnsOff(drive, estimated.odometry.rig);
    Eigen::Vector3d common = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& turn : turns) common += turn / 4;
    // What the four have in common stays the rig's, as far as the drive does not refute it.
    EXPECT_LT(common.norm() / kDegree, 0.4) << has_wheels;
    for (size_t camera = 0; camera < 4; ++camera) {
      EXPECT_NEAR(RotationErrorDeg(drive, drive.rig, camera), 1, 1e-6);
      EXPECT_LT((turns[camera] - common).norm() / kDegree, 0.1) << camera;
      // The estimate itself, before it is judged.
      const Rigid3 estimate =
          estimated.odometry.measurements->shared.cameras[camera].ImuFromCamera();
      EXPECT_LT(estimate.rotation.angularDistance(drive.true_rig.ImuFromCamera(camera).rotation) /
                    kDegree,
                0.15);
      EXPECT_NE(estimated.odometry.report.calibration[camera].quantities[0].status,
                CalibratedQuantity::Status::kKept);
    }
  }
}

TEST(SelfCalibration, WithoutItTheSameRigDriftsSeveralTimesAsMuch) {
  const SampledDrive drive = MakeCarDrive(WrongRig(3, false));
  OdometryOptions held;
  held.smoother.calibration.extrinsics = false;

  EXPECT_GT(EstimateAndCompare(drive, held).error.drift_percent,
            3 * EstimateAndCompare(drive).error.drift_percent);
}

TEST(SelfCalibration, FindsTimeOffsetsOfEitherSign) {
  SampledDriveOptions options;
  options.seed = 4;
  options.duration = 48;
  options.time_offset = 0.03;  // of cameras 0 and 2, and its negative of 1 and 3
  const SampledDrive drive = MakeCarDrive(options);

  const EstimatedDrive estimated = EstimateAndCompare(drive);

  for (size_t camera = 0; camera < 4; ++camera)
    EXPECT_NEAR(estimated.odometry.rig.cameras[camera].time_shift,
                drive.true_rig.cameras[camera].time_shift, 4e-3);
  EXPECT_LT(estimated.error.drift_percent, 0.15);
}

// At the speeds of a car park it shows in the side cameras at best.
TEST(SelfCalibration, RefinesTheLineDelayOfARollingShutterWhereItShows) {
  SampledDriveOptions options;
  options.seed = 5;
  options.duration = 48;
  options.line_delay = 4e-5;
  options.line_delay_error = 0.2;
  const SampledDrive drive = MakeCarDrive(options);

  const EstimatedDrive estimated = EstimateAndCompare(drive);

  EXPECT_LT(estimated.error.drift_percent, 0.2);
  int num_refined = 0;
  for (size_t camera = 0; camera < 4; ++camera) {
    const CalibratedQuantity& line_delay =
        estimated.odometry.report.calibration[camera].quantities[3];
    if (line_delay.status != CalibratedQuantity::Status::kRefined) continue;
    ++num_refined;
    EXPECT_LT(std::abs(estimated.odometry.rig.cameras[camera].line_delay - 4e-5),
              3 * line_delay.sigma[0])
        << camera;
  }
  EXPECT_GE(num_refined, 1);
}

TEST(SelfCalibration, NoticesAMirrorThatTurnsAndCalibratesItAnew) {
  SampledDriveOptions options;
  options.seed = 7;
  options.duration = 48;
  options.jump_camera = 1;
  options.jump_time = 12;
  options.jump_deg = 3;
  const SampledDrive drive = MakeCarDrive(options);

  const EstimatedDrive estimated = EstimateAndCompare(drive);

  EXPECT_LT(estimated.error.drift_percent, 0.15);
  ASSERT_EQ(estimated.odometry.report.degraded.size(), 1u);
  EXPECT_NE(estimated.odometry.report.degraded[0].reason.find("'left' was turned by 3.0 deg"),
            std::string::npos);
  EXPECT_NEAR(estimated.odometry.report.degraded[0].begin - drive.imu.front().time, 12, 0.3);
  EXPECT_NEAR(RotationErrorDeg(drive, drive.rig, 1), 3, 1e-6);
  EXPECT_LT(RotationErrorDeg(drive, estimated.odometry.rig, 1), 0.3);
}

TEST(SelfCalibration, AStandingCarTellsNothingAndKeepsItsRig) {
  SampledDriveOptions options = WrongRig(6, true);
  options.duration = 20;
  const SampledDrive drive = MakeRestingDrive(options);

  const OdometryResult odometry = EstimateDrive(drive);

  ASSERT_EQ(odometry.report.calibration.size(), 4u);
  for (size_t camera = 0; camera < 4; ++camera) {
    EXPECT_FALSE(odometry.report.calibration[camera].quantities.empty());
    EXPECT_LT((odometry.rig.cameras[camera].body_from_camera.translation -
               drive.rig.cameras[camera].body_from_camera.translation)
                  .norm(),
              1e-9);
    EXPECT_EQ(odometry.rig.cameras[camera].time_shift, drive.rig.cameras[camera].time_shift);
    for (const CalibratedQuantity& quantity : odometry.report.calibration[camera].quantities)
      EXPECT_EQ(quantity.status, CalibratedQuantity::Status::kKept) << quantity.name;
  }
}

TEST(FitRotation, FindsARotationAmongOutliers) {
  const Eigen::Quaterniond turn(ExpSo3({0.03, -0.08, 0.05}));
  std::vector<DirectionPair> pairs;
  for (int i = 0; i < 30; ++i) {
    const Eigen::Vector3d predicted =
        Eigen::Vector3d(std::sin(i), std::cos(1.7 * i), 0.8).normalized();
    pairs.push_back(
        {predicted, i % 5 == 0 ? Eigen::Vector3d(predicted.y(), predicted.x(), 0.3).normalized()
                               : Eigen::Vector3d(turn * predicted)});
  }

  const std::optional<Turn> found = FitRotation(pairs);

  ASSERT_TRUE(found);
  EXPECT_LT(found->measured_from_predicted.angularDistance(turn), 1e-3);
  EXPECT_LT(found->error_after, 1e-3);
  EXPECT_GT(found->error_before, 0.03);
  EXPECT_GT(found->spread, 0.15);
  pairs.resize(9);
  EXPECT_FALSE(FitRotation(pairs));
}

TEST(FitRotation, KnowsOneCarThatMovesFromAWholeViewThatTurns) {
  std::vector<DirectionPair> pairs;
  for (int i = 0; i < 20; ++i) {  // all within 10 degrees, all displaced alike
    const Eigen::Vector3d predicted =
        Eigen::Vector3d(0.15 * std::sin(i), 0.15 * std::cos(1.7 * i), 1).normalized();
    pairs.push_back({predicted, (predicted + Eigen::Vector3d(0.02, 0, 0)).normalized()});
  }

  const std::optional<Turn> found = FitRotation(pairs);

  ASSERT_TRUE(found);
  EXPECT_LT(found->error_after, 0.3 * found->error_before);  // a rotation explains it
  EXPECT_LT(found->spread, 0.05);                            // but of how little
}

TEST(GateCalibration, MovesAlongSureDirectionsOnly) {
  CameraSettings settings;
  settings.prior = {0.01, 0.02, 0.01, 1e-6};
  CameraParameters by_rig, estimate;
  PoseToParameters({}, by_rig.extrinsics.data());
  PoseToParameters({ExpSo3({0.005, 0, 0}), {0.01, 0.015, 0}}, estimate.extrinsics.data());
  estimate.timing = {0.004, 0};
  Eigen::Matrix<double, 8, 1> sigmas;
  sigmas << 0.001, 0.001, 0.001, 0.002, 0.019, 0.019, 0.009, 0;

  const Eigen::Matrix<double, 8, 8> covariance = sigmas.cwiseAbs2().asDiagonal();

  const GatedCalibration gated =
      GateCalibration("front", settings, by_rig, estimate, {covariance, covariance});

  EXPECT_NEAR(gated.parameters.ImuFromCamera().translation.x(), 0.01, 1e-9);  // sure
  EXPECT_NEAR(gated.parameters.ImuFromCamera().translation.y(), 0, 1e-9);     // as unsure as before
  EXPECT_NEAR(
      gated.parameters.ImuFromCamera().rotation.angularDistance(Eigen::Quaterniond::Identity()),
      0.005, 1e-9);
  EXPECT_NEAR(gated.parameters.time_offset(), 0, 1e-12);
  EXPECT_EQ(gated.report.quantities[0].status, CalibratedQuantity::Status::kRefined);
  EXPECT_EQ(gated.report.quantities[1].status, CalibratedQuantity::Status::kPartlyRefined);
  EXPECT_EQ(gated.report.quantities[2].status, CalibratedQuantity::Status::kKept);
}

TEST(GateCalibration, KeepsWhatIsObservedButNotSurerThanTheRig) {
  CameraSettings settings;
  settings.prior = {0.01, 0.02, 0.01, 1e-6};
  CameraParameters by_rig, estimate;
  PoseToParameters({}, by_rig.extrinsics.data());
  PoseToParameters({ExpSo3({0, 0.004, 0.005}), {0, 0, 0}}, estimate.extrinsics.data());
  Eigen::Matrix<double, 8, 1> model, sandwich;
  model << 0.001, 0.001, 0.001, 0.019, 0.019, 0.019, 0.009, 0;
  sandwich << 0.001, 0.002, 0.009, 0.019, 0.019, 0.019, 0.009, 0;  // of yaw: errors that last

  const GatedCalibration gated =
      GateCalibration("front", settings, by_rig, estimate,
                      {model.cwiseAbs2().asDiagonal(), sandwich.cwiseAbs2().asDiagonal()});

  const CalibratedQuantity& rotation = gated.report.quantities[0];
  EXPECT_NEAR(rotation.change.y(), 0.004, 1e-4);
  EXPECT_NEAR(rotation.change.z(), 0, 1e-9);
  EXPECT_NEAR(rotation.sigma.y(), 0.002, 1e-9);
  EXPECT_NEAR(rotation.sigma.z(), 0.01, 1e-9);  // the rig's
  EXPECT_EQ(rotation.status, CalibratedQuantity::Status::kPartlyRefined);
}

/// Two cameras at 10 Hz, 20 ms apart, and an IMU at 100 Hz.
class ShortLog final : public DriveLog {
 public:
  ShortLog() { rig_.cameras.resize(2); }
  const std::string& name() const override { return name_; }
  const Rig& rig() const override { return rig_; }
  TimeSpan span() const override { return {At(0), At(1)}; }
  std::unique_ptr<RecordStream> Read(const ReadOptions& options) const override {
    auto stream = std::make_unique<Stream>();
    for (int ms = 0; ms <= 1000; ms += 10) {
      stream->records.push_back(
          ImuSample{At(ms * 1e-3), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
      for (const int camera : {0, 1})
        if (ms % 100 == 20 * camera &&
            (!options.wants_image || options.wants_image(camera, At(ms * 1e-3))))
          stream->records.push_back(CameraFrame{At(ms * 1e-3), camera, {}});
    }
    return stream;
  }
  static Timestamp At(double seconds) { return TimestampFromSeconds(100 + seconds); }

 private:
  struct Stream final : RecordStream {
    std::optional<SensorRecord> Next() override {
      if (next == records.size()) return std::nullopt;
      return records[next++];
    }
    std::vector<SensorRecord> records;
    size_t next = 0;
  };
  std::string name_ = "short";
  Rig rig_;
};

TEST(CalibratedLog, ShiftsImagesAndKeepsAllRecordsInOrder) {
  const ShortLog log;
  Rig rig = log.rig();
  rig.cameras[0].time_shift = 0.033;
  rig.cameras[1].time_shift = -0.027;
  const CalibratedLog calibrated(log, rig);
  ReadOptions options;
  std::vector<Timestamp> asked;
  options.wants_image = [&](int camera, Timestamp time) {
    if (camera == 0) asked.push_back(time);
    return camera == 0 || time > ShortLog::At(0.5);
  };

  const std::unique_ptr<RecordStream> stream = calibrated.Read(options);
  std::vector<Timestamp> images[2];
  Timestamp last{0};
  int count = 0;
  for (std::optional<SensorRecord> record; (record = stream->Next()); ++count) {
    EXPECT_LE(last, TimeOf(*record));
    last = TimeOf(*record);
    if (const auto* frame = std::get_if<CameraFrame>(&*record))
      images[frame->camera].push_back(frame->time);
  }

  EXPECT_EQ(count, 101 + 11 + 4);
  EXPECT_EQ(images[0], asked);
  EXPECT_EQ(images[0].front(), ShortLog::At(0.033));
  EXPECT_EQ(images[1].front(), ShortLog::At(0.62 - 0.027));
}

}  // namespace
}  // namespace parkade
