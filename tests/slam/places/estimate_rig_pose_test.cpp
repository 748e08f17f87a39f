#include "slam/places/estimate_rig_pose.h"

#include <gtest/gtest.h>

#include <set>

#include "core/error.h"
#include "slam/baselines/relative_pose_baselines.h"
#include "slam/places/guided_matches.h"
#include "slam/places/ray_point_correspondence.h"
#include "slam/pose_graph/pose_graph.h"
#include "tests/slam/worlds/place_world.h"

namespace parkade {
namespace {

Rigid3 Level(double x, double y, double z, double yaw_deg) {
  return {ExpSo3({0, 0, yaw_deg * M_PI / 180}), {x, y, z}};
}

double AngleDeg(const Rigid3& a, const Rigid3& b) {
  return a.rotation.angularDistance(b.rotation) * 180 / M_PI;
}

TEST(RayPointCorrespondence, JacobiansMatchFiniteDifferences) {
  const PlaceWorld world = MakePlaceWorld({.a_from_b = Level(1, 0.5, 0.1, 30)});
  const Rigid3 a_from_b = Level(1.02, 0.47, 0.12, 30.3);
  constexpr double kStep = 1e-6;
  int num_checked = 0;
  for (const RayPointCorrespondence& correspondence :
       CorrespondencesOf(world.a, world.b, MatchKeyframes(world.a, world.b, {}))) {
    const CorrespondenceError error = ErrorOf(correspondence, a_from_b);
    for (int i = 0; i < 6; ++i) {
      Eigen::Vector2d sides[2];
      for (const int side : {0, 1}) {
        Vector6d delta = Vector6d::Zero();
        delta[i] = side == 0 ? -kStep : kStep;
        const Rigid3 moved = a_from_b * Rigid3{ExpSo3(delta.tail<3>()), delta.head<3>()};
        sides[side] = ErrorOf(correspondence, moved).whitened;
      }
      // The Jacobian leaves out the change of distance and of sigma: both multiply an error that is
      // nearly zero.
      const Eigen::Vector2d numeric = (sides[1] - sides[0]) / (2 * kStep);
      EXPECT_LT((numeric - error.jacobian.col(i)).norm(),
                0.1 * error.jacobian.norm() * (1 + error.whitened.norm()));
    }
    ++num_checked;
  }
  EXPECT_GT(num_checked, 100);
}

TEST(RelativePose, TwoCorrespondencesAreEnoughWhereNothingIsWrong) {
  const Rigid3 truth = Level(2, -1, 0.3, 160);
  const PlaceWorld world =
      MakePlaceWorld({.a_from_b = truth, .bearing_sigma = 1e-9, .depth_error = 1e-9});
  const std::vector<RayPointCorrespondence> correspondences =
      CorrespondencesOf(world.a, world.b, MatchKeyframes(world.a, world.b, {}));
  ASSERT_GT(correspondences.size(), 10u);
  for (const bool is_forward : {true, false}) {
    std::vector<RayPointCorrespondence> same;
    std::copy_if(correspondences.begin(), correspondences.end(), std::back_inserter(same),
                 [&](const RayPointCorrespondence& correspondence) {
                   return correspondence.is_forward == is_forward;
                 });
    double best = 1e9;
    for (const Rigid3& pose : SolveUprightPose(same[0], same[7]))
      best = std::min(best, (pose.translation - truth.translation).norm() + AngleDeg(pose, truth));
    EXPECT_LT(best, 1e-4) << is_forward;
  }
}

// Image points are known by the number of their feature here.
TEST(RelativePose, ShowsInliersOfTheTwoCamerasThatShareTheMost) {
  PlaceWorld world = MakePlaceWorld({.a_from_b = Level(1.2, 0.9, 0.05, 20), .wrong_share = 0.5});
  for (RigKeyframe* keyframe : {&world.a, &world.b}) {
    for (size_t i = 0; i < keyframe->features.size(); ++i)
      keyframe->features[i].image_point = {static_cast<float>(i), 0.5F};
    keyframe->image_times.assign(kCamerasPerKeyframe, Timestamp{keyframe == &world.a ? 7 : 9});
  }
  const RelativePose pose =
      EstimateRigPose(world.a, world.b, MatchKeyframes(world.a, world.b, {}), {});
  ASSERT_TRUE(pose.rejected.empty());
  const CameraPairInliers& most = pose.inliers_of_cameras.front();
  EXPECT_EQ(pose.shown.camera_a, most.camera_a);
  EXPECT_EQ(pose.shown.camera_b, most.camera_b);
  EXPECT_EQ(pose.shown.image_a, Timestamp{7});
  EXPECT_EQ(pose.shown.image_b, Timestamp{9});
  EXPECT_GE(pose.shown.points.size(), static_cast<size_t>(std::min(most.count, 12)));
  EXPECT_LE(pose.shown.points.size(), 24u);
  for (const MatchedPoint& point : pose.shown.points) {
    const KeyframeFeature& a = world.a.features.at(static_cast<size_t>(point.a.x()));
    const KeyframeFeature& b = world.b.features.at(static_cast<size_t>(point.b.x()));
    EXPECT_EQ(a.camera, most.camera_a);
    EXPECT_EQ(b.camera, most.camera_b);
    ASSERT_TRUE(b.point);
    const Eigen::Vector3d ray = (pose.a_from_b * *b.point - a.origin).normalized();
    EXPECT_LT(std::acos(std::min(1.0, ray.dot(a.bearing))), 0.05) << "they see the same";
  }
  for (KeyframeFeature& feature : world.a.features) feature.image_point = {-1, -1};
  EXPECT_TRUE(EstimateRigPose(world.a, world.b, MatchKeyframes(world.a, world.b, {}), {})
                  .shown.points.empty());
}

TEST(RelativePose, RigPoseIsRightInAllDirectionsAmongWrongMatches) {
  for (const double yaw_deg : {0.0, 20.0, 90.0, 178.0}) {
    for (const double wrong_share : {0.0, 0.5}) {
      const Rigid3 truth = Level(1.2, 0.9, 0.05, yaw_deg);
      const PlaceWorld world = MakePlaceWorld({.a_from_b = truth, .wrong_share = wrong_share});

      const RelativePose pose =
          EstimateRigPose(world.a, world.b, MatchKeyframes(world.a, world.b, {}), {});

      EXPECT_EQ(pose.rejected, "") << yaw_deg << " " << wrong_share;
      EXPECT_GT(pose.num_camera_pairs, 2);
      EXPECT_LT((pose.a_from_b.translation - truth.translation).norm(), 0.05)
          << yaw_deg << " " << wrong_share;
      EXPECT_LT(AngleDeg(pose.a_from_b, truth), 0.2) << yaw_deg << " " << wrong_share;
    }
  }
}

TEST(RelativePose, ARoughPoseGuidesToMoreMatches) {
  const Rigid3 truth = Level(1.2, 0.9, 0.05, 170);
  const PlaceWorld world = MakePlaceWorld({.a_from_b = truth, .wrong_share = 0.3});
  RelativePoseOptions options;
  options.ratio = 0.6;  // as where much looks alike
  const std::vector<FeatureMatch> without = MatchKeyframes(world.a, world.b, options);
  const Rigid3 rough = truth * Rigid3{ExpSo3({0, 0, 0.003}), {0.05, -0.05, 0.02}};

  const std::vector<FeatureMatch> guided = FindGuidedMatches(world.a, world.b, rough, options);

  EXPECT_GT(guided.size(), without.size() * 6 / 10);
  int num_right = 0;
  for (const RayPointCorrespondence& correspondence : CorrespondencesOf(world.a, world.b, guided))
    num_right += ErrorOf(correspondence, truth).whitened.norm() < 3.5;
  EXPECT_GT(num_right,
            static_cast<int>(CorrespondencesOf(world.a, world.b, guided).size()) * 9 / 10);
  std::set<size_t> of_a, of_b;
  for (const FeatureMatch& match : guided)
    EXPECT_TRUE(of_a.insert(match.a).second && of_b.insert(match.b).second);
}

TEST(RelativePose, ItsInformationIsHonest) {
  double sum = 0;
  constexpr int kTrials = 30;
  for (std::uint32_t seed = 1; seed <= kTrials; ++seed) {
    const Rigid3 truth = Level(1.2, 0.9, 0.05, 10);
    const PlaceWorld world = MakePlaceWorld({.a_from_b = truth, .num_points = 200, .seed = seed});
    const RelativePose pose =
        EstimateRigPose(world.a, world.b, MatchKeyframes(world.a, world.b, {}), {});
    PoseGraphEdge edge;
    edge.from_from_to = pose.a_from_b;
    const Vector6d error = RelativePoseError(edge, {}, truth);
    sum += error.dot(pose.information * error);
  }
  EXPECT_LT(sum / kTrials, 12) << "mean chi^2 with 6 degrees of freedom";
  EXPECT_GT(sum / kTrials, 0.2) << "with its floor on sigma it is cautious, not blind";
}

TEST(RelativePose, DifferentPlacesAreRejected) {
  const PlaceWorld one = MakePlaceWorld({.seed = 1}), other = MakePlaceWorld({.seed = 2});
  EXPECT_NE(EstimateRigPose(one.a, other.b, MatchKeyframes(one.a, other.b, {}), {}).rejected, "");
  // The same looks everywhere: every match is there and wrong.
  std::vector<FeatureMatch> matches;
  for (size_t i = 0; i < std::min(one.a.features.size(), other.b.features.size()); ++i)
    matches.push_back({i, i});
  EXPECT_NE(EstimateRigPose(one.a, other.b, matches, {}).rejected, "");
}

TEST(RelativePose, NothingToMatchIsNoPose) {
  EXPECT_TRUE(MatchKeyframes({}, {}, {}).empty());
  EXPECT_NE(EstimateRigPose({}, {}, {}, {}).rejected, "");
  EXPECT_NE(EstimatePnpPose({}, {}, {}, {}).rejected, "");
  EXPECT_NE(EstimateTwoViewPose({}, {}, {}, {}).rejected, "");
}

TEST(RelativePose, PnpFindsThePoseOfOneCameraOnly) {
  const Rigid3 truth = Level(1.2, 0.9, 0.05, 10);
  const PlaceWorld world = MakePlaceWorld({.a_from_b = truth});
  const RelativePose pose =
      EstimatePnpPose(world.a, world.b, MatchKeyframes(world.a, world.b, {}), {});
  EXPECT_EQ(pose.rejected, "");
  EXPECT_LT((pose.a_from_b.translation - truth.translation).norm(), 0.5);
  EXPECT_LT(AngleDeg(pose.a_from_b, truth), 2);
}

TEST(RelativePose, FivePointsKnowRotationAndDirection) {
  const Rigid3 truth = Level(2, 1, 0, 12);
  const PlaceWorld world = MakePlaceWorld({.a_from_b = truth, .bearing_sigma = 0.001});
  const TwoViewPose pose =
      EstimateTwoViewPose(world.a, world.b, MatchKeyframes(world.a, world.b, {}), {});
  ASSERT_EQ(pose.rejected, "");
  // As noisy as five rays are: nothing adjusts them afterwards.
  EXPECT_LT(AngleDeg(pose.first_from_second, truth), 2.5);
  const Eigen::Vector3d baseline = truth * pose.second_in_b - pose.first_in_a;
  EXPECT_GT(pose.first_from_second.translation.dot(baseline.normalized()), 0.98);
}

TEST(ScaleLessInformation, LeavesOutTheDirectionOfTranslation) {
  const Rigid3 measured{ExpSo3({0.1, -0.2, 0.7}), {3, 1, 0.2}};
  PoseGraphEdge edge;
  edge.from_from_to = measured;
  edge.information = ScaleLessInformation(measured, 1e-4 * Eigen::Matrix3d::Identity(), 0.1, true);
  const auto cost_of = [&edge](const Rigid3& actual) {
    const Vector6d error = RelativePoseError(edge, {}, actual);
    return error.dot(edge.information * error);
  };
  EXPECT_LT(cost_of({measured.rotation, 5 * measured.translation}), 1e-9)
      << "length does not count";
  const Eigen::Vector3d across = measured.translation.unitOrthogonal();
  EXPECT_NEAR(cost_of({measured.rotation, measured.translation + 0.1 * across}), 1, 1e-9);
  EXPECT_NEAR(cost_of({measured.rotation * ExpSo3({0, 0.01, 0}), measured.translation}), 1, 1e-3);
  edge.information = ScaleLessInformation(measured, 1e-4 * Eigen::Matrix3d::Identity(), 0.1, false);
  EXPECT_LT(cost_of({measured.rotation, measured.translation + across}), 1e-9) << "rotation only";
}

TEST(RelativePose, OptionsThatMakeNoSenseAreRefused) {
  for (const RelativePoseOptions& options :
       {RelativePoseOptions{.max_hamming = 0}, RelativePoseOptions{.ratio = 1.5},
        RelativePoseOptions{.iterations = 0}, RelativePoseOptions{.min_inliers = 2}})
    EXPECT_THROW(options.Validate(), Error);
}

}  // namespace
}  // namespace parkade
