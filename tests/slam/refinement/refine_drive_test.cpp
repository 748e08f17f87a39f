#include "slam/refinement/refine_drive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/error.h"
#include "slam/odometry/odometry_file.h"
#include "slam/places/rig_keyframe.h"
#include "slam/smoother/drive_measurements.h"
#include "tests/slam/worlds/estimated_drive.h"

namespace parkade {
namespace {

/// A drive without images and its odometry: two cameras and IMU, no wheels.
struct TrackedDrive {
  std::uint32_t seed = 3;
  SampledDrive drive = MakeCarDrive({.seed = seed,
                                     .duration = 24,
                                     .camera_rate = 10,
                                     .num_cameras = 2,
                                     .has_wheels = false,
                                     .tracks = 40,
                                     .rig_rotation_deg = 0.2});
  OdometryResult odometry = EstimateDrive(drive);

  double ErrorOf(const Trajectory& odom_from_body) const {
    return EvaluateTrajectory(drive.truth, ToTimedPoses(odom_from_body)).rigid.translation.rmse;
  }
};

/// One that several tests use, made once.
const TrackedDrive& Tracked() {
  static const TrackedDrive tracked;
  return tracked;
}

Rigid3 TruthAt(const SampledDrive& drive, Timestamp time) {
  const auto after =
      std::lower_bound(drive.truth.begin(), drive.truth.end(), time,
                       [](const TimedPose& pose, Timestamp t) { return pose.time < t; });
  return LeveledPose(std::min(after, drive.truth.end() - 1)->world_from_frame);
}

/// Loops as a perfect recognition would measure them, from truth, off by `shift` [m] and noise of
/// their sigma.
LoopClosure LoopsOf(const TrackedDrive& tracked, double shift) {
  constexpr double kSigma = 0.01, kTurn = 1e-3;
  LoopClosure closure;
  closure.odom_from_body = tracked.odometry.odom_from_body;
  std::mt19937 random(5);
  std::normal_distribution<double> noise;
  const auto draw = [&](double sigma) {
    return Eigen::Vector3d(sigma * noise(random), sigma * noise(random), sigma * noise(random));
  };
  const Timestamp begin = tracked.drive.truth.front().time;
  for (int i = 0; i < 20; ++i) {
    LoopEvidence& loop = closure.loops.emplace_back();
    // Truth is at 100 Hz: no interpolation.
    loop.earlier = begin + (3.0 + 0.2 * i);
    loop.later = begin + (15.0 + 0.4 * i);
    loop.pose.a_from_b = TruthAt(tracked.drive, loop.earlier).Inverse() *
                         TruthAt(tracked.drive, loop.later) *
                         Rigid3{ExpSo3(draw(kTurn)), draw(kSigma)};
    loop.pose.a_from_b.translation.x() += i % 2 == 0 ? shift : -shift;
    Vector6d variances;
    variances << Eigen::Vector3d::Constant(kSigma * kSigma),
        Eigen::Vector3d::Constant(kTurn * kTurn);
    loop.pose.information = variances.cwiseInverse().asDiagonal();
    loop.weight = 1;
  }
  closure.num_accepted = 20;
  return closure;
}

TEST(RefineDrive, GoodLoopsBringTheDriveNearerToTheTruth) {
  const TrackedDrive& tracked = Tracked();

  const DriveRefinement refined =
      RefineDrive(tracked.odometry, tracked.drive.rig, LoopsOf(tracked, 0), {.enabled = true});

  ASSERT_TRUE(refined.is_accepted) << refined.reason;
  EXPECT_EQ(refined.num_held_out, 4);
  EXPECT_LT(refined.after.unused_loops, refined.before.unused_loops);
  EXPECT_GT(refined.after.num_bearings, 2000u);
  const double before = tracked.ErrorOf(tracked.odometry.odom_from_body),
               after = tracked.ErrorOf(refined.odom_from_body);
  EXPECT_LT(after, 0.7 * before) << before;
  EXPECT_LT(after, 0.02) << "[m]: loops of 1 cm, twenty of them";
  EXPECT_EQ(refined.odom_from_body.span().begin, tracked.odometry.odom_from_body.span().begin);
  EXPECT_EQ(refined.odom_from_body.span().end, tracked.odometry.odom_from_body.span().end);
}

/// Mean square of the amounts of modes by which a refined drive differs from the truth, [sigma^2].
double MeanSquareOfBends(const TrackedDrive& tracked, const DriveRefinement& refined) {
  const CovarianceModes& modes = refined.modes;
  std::vector<Rigid3> truth, estimate;
  for (const Timestamp time : modes.times) {
    const std::optional<Rigid3> pose = refined.odom_from_body.At(time);
    const auto after =
        std::lower_bound(tracked.drive.truth.begin(), tracked.drive.truth.end(), time,
                         [](const TimedPose& pose, Timestamp t) { return pose.time < t; });
    if (!pose || after == tracked.drive.truth.end()) return -1;
    truth.push_back(after->world_from_frame);
    estimate.push_back(*pose);
  }
  // Position and yaw of the first pose are the estimate's choice.
  const Rigid3 frame = LeveledPose(estimate.front()) * LeveledPose(truth.front()).Inverse();
  Eigen::VectorXd error(modes.modes.rows());
  for (size_t i = 0; i < truth.size(); ++i) {
    const Rigid3 actual = frame * truth[i];
    error.segment<6>(6 * static_cast<Eigen::Index>(i))
        << LogSo3(actual.rotation * estimate[i].rotation.conjugate()),
        actual.translation - estimate[i].translation;
  }
  // The likeliest amounts beside a millimeter of what no mode has.
  const Eigen::MatrixXd normal = modes.modes.transpose() * modes.modes +
                                 1e-6 * Eigen::MatrixXd::Identity(modes.size(), modes.size());
  const Eigen::VectorXd amounts = normal.ldlt().solve(modes.modes.transpose() * error);
  return amounts.squaredNorm() / static_cast<double>(modes.size());
}

TEST(RefineDrive, PiecesComeOutNearTheWhole) {
  const TrackedDrive& tracked = Tracked();
  const LoopClosure closure = LoopsOf(tracked, 0);

  const DriveRefinement pieces =
      RefineDrive(tracked.odometry, tracked.drive.rig, closure,
                  {.enabled = true, .max_nodes = 100, .piece_nodes = 100});

  EXPECT_GE(pieces.num_pieces, 2);
  EXPECT_TRUE(pieces.modes.empty());
  ASSERT_TRUE(pieces.is_accepted) << pieces.reason;
  EXPECT_LT(tracked.ErrorOf(pieces.odom_from_body),
            tracked.ErrorOf(tracked.odometry.odom_from_body));
}

TEST(RefineDrive, LoopsThatContradictTheDriveAndEachOtherChangeNothing) {
  const TrackedDrive& tracked = Tracked();

  const DriveRefinement refined =
      RefineDrive(tracked.odometry, tracked.drive.rig, LoopsOf(tracked, 2), {.enabled = true});

  if (refined.is_accepted) {
    EXPECT_LT(tracked.ErrorOf(refined.odom_from_body),
              1.3 * tracked.ErrorOf(tracked.odometry.odom_from_body));
  } else {
    EXPECT_EQ(tracked.ErrorOf(refined.odom_from_body),
              tracked.ErrorOf(tracked.odometry.odom_from_body));
    EXPECT_NE(refined.reason, "");
  }
}

TEST(RefineDrive, NeedsNoLoops) {
  const TrackedDrive& tracked = Tracked();
  LoopClosure none;
  none.odom_from_body = tracked.odometry.odom_from_body;

  const DriveRefinement refined =
      RefineDrive(tracked.odometry, tracked.drive.rig, none, {.enabled = true});

  ASSERT_TRUE(refined.is_accepted) << refined.reason;
  EXPECT_EQ(refined.num_held_out, 0);
  EXPECT_LT(refined.after.unused_bearings, 1.08 * refined.before.unused_bearings);
}

// Not each of them: what a drive without loops does not tell, scale above all, may as well come out
// worse.
TEST(RefineDrive, DrivesWithoutLoopsComeOutBetterTakenTogetherAndKnowHowTheyMayBeOff) {
  double before = 0, after = 0, bends = 0;
  for (const std::uint32_t seed : {3u, 4u, 5u}) {
    const TrackedDrive tracked{.seed = seed};
    LoopClosure none;
    none.odom_from_body = tracked.odometry.odom_from_body;

    const DriveRefinement refined =
        RefineDrive(tracked.odometry, tracked.drive.rig, none, {.enabled = true});

    ASSERT_TRUE(refined.is_accepted) << refined.reason;
    before += std::pow(tracked.ErrorOf(tracked.odometry.odom_from_body), 2);
    after += std::pow(tracked.ErrorOf(refined.odom_from_body), 2);
    ASSERT_GT(refined.modes.size(), 3);
    bends += MeanSquareOfBends(tracked, refined) / 3;
  }

  EXPECT_LT(std::sqrt(after / before), 0.9);
  EXPECT_GT(bends, 0.2);
  EXPECT_LT(bends, 3);
}

/// What an RTK receiver reports every half second, one fix in ten being 5 m off.
GnssPositions FixesOf(const TrackedDrive& tracked, double sigma) {
  const SiteDatum datum{48, 11, 500};
  const Rigid3 site_from_world{ExpSo3({0, 0, 2.1}), {30, -50, 2}};
  GnssPositions gnss;
  gnss.antenna_in_body = {0.9, 0.1, 1.5};
  gnss.options.correlation_time = 0;
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, sigma);
  for (size_t i = 0; i < tracked.drive.truth.size(); i += 50) {
    const TimedPose& pose = tracked.drive.truth[i];
    Eigen::Vector3d antenna = site_from_world * (pose.world_from_frame * gnss.antenna_in_body);
    for (double& coordinate : antenna) coordinate += noise(random);
    if (i % 500 == 250) antenna.x() += 5;
    const Geodetic position = GeodeticFromSite(datum, antenna);
    gnss.fixes.push_back({pose.time, position.latitude_deg, position.longitude_deg,
                          position.altitude, Eigen::Vector3d::Constant(sigma)});
  }
  return gnss;
}

TEST(RefineDrive, GnssHoldsTheDriveInPlaceAndItsOutliersDoNot) {
  const TrackedDrive& tracked = Tracked();
  LoopClosure none;
  none.odom_from_body = tracked.odometry.odom_from_body;

  const DriveRefinement refined = RefineDrive(tracked.odometry, tracked.drive.rig, none,
                                              {.enabled = true}, FixesOf(tracked, 0.02));

  ASSERT_TRUE(refined.is_accepted) << refined.reason;
  EXPECT_GT(refined.num_fixes, 40);
  EXPECT_LT(refined.after.gnss, 1.5);
  EXPECT_LT(tracked.ErrorOf(refined.odom_from_body), 0.012) << "[m]: fifty fixes of 2 cm";
}

TEST(RefineDrive, TracksThatFitWorseThanAskedForRefuseIt) {
  const TrackedDrive& tracked = Tracked();

  const DriveRefinement refined =
      RefineDrive(tracked.odometry, tracked.drive.rig, LoopsOf(tracked, 0),
                  {.enabled = true, .max_iterations = 2, .max_track_growth = 0.1});

  EXPECT_FALSE(refined.is_accepted);
  EXPECT_EQ(refined.reason, "held-out tracks got worse");
  EXPECT_EQ(tracked.ErrorOf(refined.odom_from_body),
            tracked.ErrorOf(tracked.odometry.odom_from_body));
}

TEST(RefineDrive, SaysWhyNothingWasDone) {
  const TrackedDrive& tracked = Tracked();
  LoopClosure none;
  none.odom_from_body = tracked.odometry.odom_from_body;

  EXPECT_EQ(
      RefineDrive(tracked.odometry, tracked.drive.rig, LoopsOf(tracked, 0), {.enabled = false})
          .reason,
      "switched off");
  EXPECT_EQ(
      RefineDrive(tracked.odometry, tracked.drive.rig, none, {.enabled = true, .min_nodes = 100000})
          .reason,
      "the drive is too short");
  EXPECT_THROW(RefineDrive(tracked.odometry, tracked.drive.rig, none, {.held_out_share = 1}),
               Error);
}

TEST(RefineDrive, WhatWasWrittenIsReadAndRefinesAlike) {
  const TrackedDrive& tracked = Tracked();
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / "odometry_file_test.bin";

  WriteOdometry(tracked.odometry, tracked.drive.rig, file);
  const OdometryResult read = ReadOdometry(file, tracked.drive.rig);

  const LoopClosure closure = LoopsOf(tracked, 0);
  const RefinementOptions quick{.enabled = true, .max_iterations = 2};
  EXPECT_EQ(tracked.ErrorOf(RefineDrive(read, tracked.drive.rig, closure, quick).odom_from_body),
            tracked.ErrorOf(
                RefineDrive(tracked.odometry, tracked.drive.rig, closure, quick).odom_from_body))
      << "bit by bit";
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace parkade
