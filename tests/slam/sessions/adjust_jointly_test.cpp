#include "slam/sessions/adjust_jointly.h"

#include <gtest/gtest.h>

#include <cmath>

#include "slam/sessions/join_drives.h"
#include "slam/sessions/random_walk_modes.h"

namespace parkade {
namespace {

constexpr size_t kKeyframes = 41;

/// A drive along 40 m of x, a keyframe in a meter, whose way is stretched by a share of itself and
/// which knows that it may.
DriveToJoin StretchedDrive(double stretch, bool is_opposite = false) {
  DriveToJoin drive;
  const Rigid3 turn{ExpSo3({0, 0, is_opposite ? M_PI : 0}), Eigen::Vector3d::Zero()};
  for (size_t i = 0; i < kKeyframes; ++i) {
    RigKeyframe& keyframe = drive.keyframes.emplace_back();
    keyframe.time = Timestamp{} + static_cast<double>(i);
    keyframe.distance = static_cast<double>(i);
    const double way =
        is_opposite ? static_cast<double>(kKeyframes - 1 - i) : static_cast<double>(i);
    keyframe.odom_from_keyframe =
        Rigid3{Eigen::Quaterniond::Identity(), {(1 + stretch) * way, 0, 0}} * turn;
  }
  drive.modes.times = {drive.keyframes.front().time, drive.keyframes.back().time};
  drive.modes.modes = Eigen::MatrixXd::Zero(12, 1);
  drive.modes.modes(is_opposite ? 3 : 9, 0) = 0.005 * 40;
  return drive;
}

/// All keyframes that lie on each other, as far off as `in_b` says, to a centimeter and a
/// milliradian.
DrivePair Linked(size_t a, size_t b, bool is_opposite, const Rigid3& in_b = {}) {
  DrivePair pair{a, b, {}, {}, {}};
  for (size_t i = 0; i < kKeyframes; ++i) {
    SessionLoop& link =
        pair.found.links.emplace_back(SessionLoop{i, is_opposite ? kKeyframes - 1 - i : i, 1, {}});
    link.pose.a_from_b =
        Rigid3{ExpSo3({0, 0, is_opposite ? M_PI : 0}), Eigen::Vector3d::Zero()} * in_b;
    link.pose.information = 1e4 * Matrix6d::Identity();
    link.pose.information.bottomRightCorner<3, 3>() *= 100;
  }
  pair.weights.assign(kKeyframes, 1);
  pair.chi_squared.assign(kKeyframes, 0);
  return pair;
}

std::vector<std::vector<Rigid3>> PosesOf(const std::vector<DriveToJoin>& drives) {
  std::vector<std::vector<Rigid3>> poses(drives.size());
  for (size_t i = 0; i < drives.size(); ++i)
    for (const RigKeyframe& keyframe : drives[i].keyframes)
      poses[i].push_back(keyframe.odom_from_keyframe);
  return poses;
}

double Length(const std::vector<Rigid3>& poses) {
  return (poses.back().translation - poses.front().translation).norm();
}

TEST(AdjustJointly, DrivesMeetHalfwayByTheirModes) {
  const std::vector<DriveToJoin> drives = {StretchedDrive(0.005), StretchedDrive(-0.005)};
  std::vector<std::vector<Rigid3>> poses = PosesOf(drives);
  DrivePair pair = Linked(0, 1, false);

  const JointAdjustment adjustment = AdjustJointly(drives, {}, {}, {&pair}, poses);

  EXPECT_EQ(adjustment.num_links, static_cast<int>(kKeyframes));
  EXPECT_NEAR(adjustment.largest_correction, 0.2, 0.05);
  EXPECT_LT(adjustment.after, 1);
  EXPECT_NEAR(Length(poses[0]), 40, 0.01);
  EXPECT_NEAR(Length(poses[1]), 40, 0.01);
  for (size_t i = 0; i < kKeyframes; ++i)
    EXPECT_LT((poses[0][i].translation - poses[1][i].translation).norm(), 0.01) << i;
  EXPECT_LT(*std::max_element(pair.chi_squared.begin(), pair.chi_squared.end()), 1);
}

TEST(AdjustJointly, ADriveThatKnowsItselfIsNotBent) {
  std::vector<DriveToJoin> drives = {StretchedDrive(0), StretchedDrive(-0.005)};
  drives[0].modes.modes *= 0.01;
  std::vector<std::vector<Rigid3>> poses = PosesOf(drives);
  DrivePair pair = Linked(0, 1, false);

  AdjustJointly(drives, {}, {}, {&pair}, poses);

  EXPECT_NEAR(Length(poses[0]), 40, 0.001);
  EXPECT_NEAR(Length(poses[1]), 40, 0.01);
}

/// [m] by which the way back lies beside the way out after the adjustment, of a drive that takes
/// the same lane both ways and sees everything 2 cm to its left, while it may be bent by a
/// centimeter where it turns.
double WidthOfWayThereAndBack(double mount_translation) {
  const DriveToJoin out = StretchedDrive(0);
  DriveToJoin both = StretchedDrive(0);
  const DriveToJoin back = StretchedDrive(0, /*is_opposite=*/true);
  for (const RigKeyframe& keyframe : back.keyframes) {
    both.keyframes.push_back(keyframe);
    both.keyframes.back().time = keyframe.time + 100;
    both.keyframes.back().distance += 100;
  }
  both.modes.times = {both.keyframes[kKeyframes - 1].time, both.keyframes[kKeyframes].time};
  both.modes.modes = Eigen::MatrixXd::Zero(12, 1);
  both.modes.modes(10, 0) = 0.01;
  const Rigid3 left{Eigen::Quaterniond::Identity(), {0, 0.02, 0}};
  DrivePair pair = Linked(0, 1, false, left);
  DrivePair opposite = Linked(0, 1, true, left);
  for (size_t i = 0; i < kKeyframes; ++i) {
    pair.found.links.push_back(opposite.found.links[i]);
    pair.found.links.back().keyframe_b += kKeyframes;
    pair.weights.push_back(1);
    pair.chi_squared.push_back(0);
  }
  const std::vector<DriveToJoin> drives = {out, both};
  std::vector<std::vector<Rigid3>> poses = PosesOf(drives);
  LoopOptions options;
  options.relative_pose.mount_translation = mount_translation;
  AdjustJointly(drives, options, {}, {&pair}, poses);
  return std::abs(poses[1].front().translation.y() - poses[1].back().translation.y());
}

TEST(AdjustJointly, MountsThatAreOffDoNotBendTheDrive) {
  EXPECT_GT(WidthOfWayThereAndBack(1e-6), 0.02);
  EXPECT_LT(WidthOfWayThereAndBack(0.015), 0.01);
}

TEST(AdjustJointly, LinksWithoutWeightPullNothing) {
  const std::vector<DriveToJoin> drives = {StretchedDrive(0), StretchedDrive(0)};
  std::vector<std::vector<Rigid3>> poses = PosesOf(drives);
  DrivePair pair = Linked(0, 1, false);
  for (size_t i = 0; i < kKeyframes; i += 2) {
    pair.weights[i] = 0;
    pair.found.links[i].pose.a_from_b.translation.y() = 1;
  }
  AdjustJointly(drives, {}, {}, {&pair}, poses);
  EXPECT_LT((poses[1][20].translation - poses[0][20].translation).norm(), 1e-3);
}

TEST(AdjustJointly, DrivesWithoutModesWalk) {
  std::vector<DriveToJoin> drives = {StretchedDrive(0), StretchedDrive(-0.0005)};
  drives[0].modes.modes *= 0.01;
  drives[1].modes = {};
  std::vector<std::vector<Rigid3>> poses = PosesOf(drives);
  DrivePair pair = Linked(0, 1, false);

  AdjustJointly(drives, {}, {}, {&pair}, poses);

  EXPECT_NEAR(Length(poses[1]), 40, 0.007) << "2 cm before";
}

TEST(RandomWalkModes, GrowWithTheWay) {
  DriveToJoin drive = StretchedDrive(0);
  const LoopOptions options;
  const CovarianceModes modes = RandomWalkModes(drive, options);
  const auto sigma_at = [&](size_t keyframe) {
    const Eigen::MatrixXd at = modes.At(drive.keyframes[keyframe].time);
    return at.row(3).norm();
  };
  EXPECT_NEAR(sigma_at(0), 0, 1e-9);
  EXPECT_NEAR(sigma_at(40), options.odometry_translation * std::sqrt(40.0), 0.1 * sigma_at(40));
  EXPECT_NEAR(sigma_at(10), options.odometry_translation * std::sqrt(10.0), 0.1 * sigma_at(10));
}

}  // namespace
}  // namespace parkade
