#include "slam/sessions/stage_results.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/slam/worlds/drive_world.h"

namespace parkade {
namespace {

DriveRefinement SomeRefinement() {
  DriveRefinement refinement;
  refinement.odom_from_body = DriveWorld().Drive(3).drive.odom_from_body;
  refinement.rig.cameras.resize(2);
  refinement.rig.cameras[1].body_from_camera.translation = {1, 2, 3};
  refinement.rig.cameras[1].time_shift = 0.01;
  refinement.is_accepted = true;
  refinement.reason = "because";
  refinement.before.imu = 1.5;
  refinement.after.num_landmarks = 7;
  refinement.cameras = {{"cam0", 0.1, 0.2, 0.3, true}};
  refinement.wheel_scale = 1.01;
  refinement.num_pieces = 3;
  refinement.modes = {{Timestamp{5}, Timestamp{7}}, Eigen::MatrixXd::Random(12, 3)};
  refinement.seconds = 12;
  return refinement;
}

TEST(StageResults, LinksComeBackWithEveryBit) {
  const DriveWorld world;
  const SessionLoops links =
      MatchSessions(world.Drive(1).drive.keyframes, world.Drive(2).drive.keyframes, {}, {});
  ASSERT_FALSE(links.links.empty());
  const std::string bytes = EncodeLinks(links);
  EXPECT_EQ(EncodeLinks(DecodeLinks(bytes)), bytes);
  EXPECT_EQ(DecodeLinks(bytes).links.back().pose.information, links.links.back().pose.information);
}

TEST(StageResults, LoopsComeBackWithTheirImagesButNotTheirTime) {
  LoopClosure loops;
  loops.odom_from_body = DriveWorld().Drive(3).drive.odom_from_body;
  loops.seconds = 9;
  loops.num_accepted = 1;
  loops.loops.resize(1);
  loops.loops[0].id = "3-17";
  loops.loops[0].weight = 0.75;
  loops.loops[0].later_keyframe = 1;
  loops.views[{1, 3}] = std::string("no \0 end", 8);
  loops.loops[0].pose.inliers_of_cameras = {{0, 3, 44}};
  loops.loops[0].pose.shown = {0, 3, Timestamp{5}, Timestamp{6}, {{{0.1F, 0.2F}, {0.3F, 0.4F}}}};
  const LoopClosure read = DecodeLoops(EncodeLoops(loops));
  EXPECT_EQ(read.seconds, 0);
  EXPECT_EQ(read.num_accepted, 1);
  EXPECT_EQ(read.loops[0].id, "3-17");
  EXPECT_EQ(read.loops[0].weight, 0.75);
  EXPECT_EQ(read.loops[0].pose.inliers_of_cameras[0].count, 44);
  EXPECT_EQ(read.loops[0].pose.shown.image_b, Timestamp{6});
  ASSERT_EQ(read.loops[0].pose.shown.points.size(), 1u);
  EXPECT_EQ(read.loops[0].pose.shown.points[0].b, Eigen::Vector2f(0.3F, 0.4F));
  EXPECT_EQ(read.views, loops.views);
  EXPECT_EQ(read.odom_from_body.states().size(), loops.odom_from_body.states().size());
}

// A preview of a map that an older version made shows its loops.
TEST(StageResults, LoopsOfAnOlderVersionHaveNoViews) {
  LoopClosure loops;
  loops.loops.resize(2);
  loops.loops[1].id = "3-17";
  loops.loops[1].odometry_disagreement = 0.5;
  const std::string bytes = EncodeLoops(loops);
  const LoopClosure read =
      DecodeLoops(std::string_view(bytes).substr(0, bytes.size() - sizeof(std::uint64_t)));
  ASSERT_EQ(read.loops.size(), 2u);
  EXPECT_EQ(read.loops[1].id, "3-17");
  EXPECT_EQ(read.loops[1].odometry_disagreement, 0.5);
  EXPECT_TRUE(read.views.empty());
  EXPECT_THROW(DecodeLoops(bytes + "x"), Error);
}

TEST(StageResults, ARefinementComesBackOntoItsRig) {
  const DriveRefinement refinement = SomeRefinement();
  Rig rig;
  rig.cameras.resize(2);
  rig.cameras[1].name = "kept";
  const DriveRefinement read = DecodeRefinement(EncodeRefinement(refinement), rig);
  EXPECT_EQ(read.modes.times, refinement.modes.times);
  EXPECT_EQ(read.modes.modes, refinement.modes.modes);
  EXPECT_EQ(read.rig.cameras[1].name, "kept");
  EXPECT_EQ(read.rig.cameras[1].body_from_camera.translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(read.rig.cameras[1].time_shift, 0.01);
  EXPECT_TRUE(read.is_accepted);
  EXPECT_EQ(read.reason, "because");
  EXPECT_EQ(read.before.imu, 1.5);
  EXPECT_EQ(read.after.num_landmarks, 7u);
  EXPECT_EQ(read.cameras[0].time_offset, 0.3);
  EXPECT_EQ(read.num_pieces, 3);
  EXPECT_EQ(read.seconds, 0);
  rig.cameras.resize(3);
  EXPECT_THROW(DecodeRefinement(EncodeRefinement(refinement), rig), Error);
}

TEST(StageResults, TheAgreementOfSensorsComesBackWithEveryBit) {
  const SensorAgreement agreement{.turn_gain = 0.1,
                                  .turn_gain_sigma = 0.2,
                                  .turn_delay = 0.3,
                                  .turn_delay_sigma = 0.4,
                                  .leads = {{"cam0", 0.5, 0.6}, {"cam1", 0.7, 0.8}},
                                  .body_lead = 0.9,
                                  .body_lead_sigma = 1.1,
                                  .num_pairs = 12};
  const std::string bytes = EncodeAgreement(agreement);
  const SensorAgreement read = DecodeAgreement(bytes);
  EXPECT_EQ(read.turn_gain, 0.1);
  EXPECT_EQ(read.turn_delay_sigma, 0.4);
  ASSERT_EQ(read.leads.size(), 2u);
  EXPECT_EQ(read.leads[1].camera, "cam1");
  EXPECT_EQ(read.leads[1].sigma, 0.8);
  EXPECT_EQ(read.body_lead_sigma, 1.1);
  EXPECT_EQ(read.num_pairs, 12);
  EXPECT_EQ(EncodeAgreement(read), bytes);
  EXPECT_THROW(DecodeAgreement(bytes.substr(1)), Error);
}

TEST(StageResults, ResidualsComeBackWithEveryBit) {
  const DriveResiduals residuals{{{Timestamp{3}, 1, 40, 0.001}, {Timestamp{4}, 2, 0, 0}},
                                 {{Timestamp{5}, 0.25}}};
  const std::string bytes = EncodeResiduals(residuals);
  const DriveResiduals read = DecodeResiduals(bytes);
  ASSERT_EQ(read.images.size(), 2u);
  EXPECT_EQ(read.images[0].time, Timestamp{3});
  EXPECT_EQ(read.images[0].camera, 1);
  EXPECT_EQ(read.images[0].num_inliers, 40);
  EXPECT_EQ(read.images[0].rms, 0.001);
  ASSERT_EQ(read.wheels.size(), 1u);
  EXPECT_EQ(read.wheels[0].time, Timestamp{5});
  EXPECT_EQ(read.wheels[0].speed, 0.25);
  EXPECT_EQ(EncodeResiduals(read), bytes);
}

TEST(StageResults, WhatIsCutOffIsNoResult) {
  const std::string bytes = EncodeResiduals({{{Timestamp{3}, 1, 40, 0.001}}, {}});
  for (const size_t length : {size_t{0}, size_t{7}, bytes.size() / 2, bytes.size() - 1})
    EXPECT_THROW(DecodeResiduals(std::string_view(bytes).substr(0, length)), Error) << length;
  EXPECT_THROW(DecodeResiduals(bytes + "x"), Error);
}

}  // namespace
}  // namespace parkade
