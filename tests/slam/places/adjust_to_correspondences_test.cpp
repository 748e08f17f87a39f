#include "slam/places/adjust_to_correspondences.h"

#include <gtest/gtest.h>

#include "slam/places/estimate_rig_pose.h"
#include "tests/slam/worlds/place_world.h"

namespace parkade {
namespace {

Rigid3 Level(double x, double y, double yaw_deg) {
  return {ExpSo3({0, 0, yaw_deg * M_PI / 180}), {x, y, 0.05}};
}

std::vector<RayPointCorrespondence> CorrespondencesAt(const Rigid3& a_from_b) {
  const PlaceWorld world =
      MakePlaceWorld({.a_from_b = a_from_b, .bearing_sigma = 1e-3, .depth_error = 0.02});
  return CorrespondencesOf(world.a, world.b, MatchKeyframes(world.a, world.b, {}));
}

TEST(MountJacobians, MatchFiniteDifferences) {
  const Rigid3 truth = Level(1, 0.5, 150);
  constexpr double kStep = 1e-6;
  const std::vector<RayPointCorrespondence> correspondences = CorrespondencesAt(truth);
  ASSERT_FALSE(correspondences.empty());
  for (const RayPointCorrespondence& correspondence : correspondences) {
    const MountJacobians jacobians = MountJacobiansOf(correspondence, truth);
    for (int i = 0; i < 6; ++i) {
      Vector6d change = Vector6d::Zero();
      change[i] = kStep;
      const Eigen::Vector3d shift = change.head<3>(), turn = change.tail<3>();
      RayPointCorrespondence of_ray = correspondence, of_point = correspondence;
      of_ray.origin += shift;
      of_point.point_origin += shift;
      of_point.point = of_point.point_origin +
                       ExpSo3(turn) * (correspondence.point - correspondence.point_origin);
      // A ray that turns: the same as the view turned back, since the axes across it turn with it.
      const Eigen::Vector2d before = ErrorOf(correspondence, truth).whitened;
      if (i < 3) {
        EXPECT_LT(
            ((ErrorOf(of_ray, truth).whitened - before) / kStep - jacobians.by_ray.col(i)).norm(),
            0.05 * jacobians.by_ray.norm());
      }
      EXPECT_LT(
          ((ErrorOf(of_point, truth).whitened - before) / kStep - jacobians.by_point.col(i)).norm(),
          0.05 * jacobians.by_point.norm());
    }
  }
}

/// [m, rad] of a pose by what one camera of the first place sees.
Vector6d SigmasAt(const Rigid3& truth, const RelativePoseOptions& options) {
  std::vector<RayPointCorrespondence> correspondences = CorrespondencesAt(truth);
  std::erase_if(correspondences, [](const RayPointCorrespondence& correspondence) {
    return correspondence.camera_pair / kCamerasPerKeyframe != 0;
  });
  Rigid3 pose = truth;
  const Matrix6d hessian = AdjustToCorrespondences(correspondences, 0.005, pose);
  return CovarianceOfCorrespondences(correspondences, hessian, pose, options)
      .diagonal()
      .cwiseSqrt();
}

TEST(CovarianceOfCorrespondences,
     MountsCancelWhereTheCarHeadsTheSameWayAndNotWhereItHeadsTheOther) {
  RelativePoseOptions exact, off;
  exact.mount_rotation_deg = exact.mount_translation = 0;
  off.mount_rotation_deg = 0.2;
  off.mount_translation = 0;
  const auto added = [&](double yaw_deg) {
    const Rigid3 truth = Level(0.1, 0, yaw_deg);
    return std::sqrt(std::pow(SigmasAt(truth, off)[5], 2) - std::pow(SigmasAt(truth, exact)[5], 2));
  };
  const double same = added(0), opposite = added(180);
  EXPECT_LT(same, 0.2 * off.mount_rotation_deg * M_PI / 180);
  EXPECT_GT(opposite, 0.7 * off.mount_rotation_deg * M_PI / 180)
      << "yaw: front and rear camera err in their own ways";
}

}  // namespace
}  // namespace parkade
