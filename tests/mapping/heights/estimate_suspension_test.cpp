#include "mapping/heights/estimate_suspension.h"

#include <gtest/gtest.h>

#include <cmath>

namespace parkade {
namespace {

constexpr double kRadius = 10, kSpeed = 5;  // [m], [m/s]: 2.5 m/s^2 to the left
constexpr double kRoll = 0.006;             // [rad/(m/s^2)]

/// Half a circle to the left on level ground, after a straight run; the body rolls as the car
/// turns.
DrivenPath LeaningPath(double roll) {
  std::vector<TrajectoryState> states;
  const double straight = 20;
  for (int i = 0; i < 500; ++i) {
    const double time = 0.02 * i, along = kSpeed * time - straight;
    const double turn = std::max(0.0, along) / kRadius;
    const double lean = along > 0 ? roll * kSpeed * kSpeed / kRadius : 0;
    TrajectoryState state;
    state.time = TimestampFromSeconds(time);
    state.world_from_body.translation = {along < 0 ? along : kRadius * std::sin(turn),
                                         along < 0 ? 0 : kRadius * (1 - std::cos(turn)), 0};
    state.world_from_body.rotation = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()) *
                                     Eigen::AngleAxisd(lean, Eigen::Vector3d::UnitX());
    states.push_back(state);
  }
  DrivenPath path;
  path.site_from_body = Trajectory(std::move(states));
  path.contact = {2.6, 1.6};
  return path;
}

std::vector<HeightObservation> LevelGround(double step) {
  std::vector<HeightObservation> heights;
  for (double x = -30; x < 20; x += step)
    for (double y = -10; y < 30; y += step) heights.push_back({{x, y, 0}, 1e4, 0.01});
  return heights;
}

TEST(EstimateSuspension, AccelerationIsTowardTheInsideOfTheBend) {
  const DrivenPath path = LeaningPath(0);
  const Eigen::Vector2d straight = AccelerationAt(path.site_from_body, TimestampFromSeconds(2));
  const Eigen::Vector2d turning = AccelerationAt(path.site_from_body, TimestampFromSeconds(7));

  EXPECT_LT(straight.norm(), 1e-6);
  EXPECT_NEAR(turning.x(), 0, 1e-3);
  EXPECT_NEAR(turning.y(), kSpeed * kSpeed / kRadius, 0.01);
  EXPECT_TRUE(AccelerationAt(path.site_from_body, TimestampFromSeconds(0.1)).isZero())
      << "no past to compare with";
}

TEST(EstimateSuspension, TheRollOfABendIsFound) {
  const SuspensionModel lean = EstimateSuspension(LeaningPath(kRoll), LevelGround(1.2)).lean;

  EXPECT_NEAR(lean.roll, kRoll, 0.1 * kRoll);
  EXPECT_NEAR(lean.pitch, 0, 1e-4);
}

TEST(EstimateSuspension, ContactsOfALeaningCarLieOnTheGround) {
  DrivenPath path = LeaningPath(kRoll);
  path.lean.roll = kRoll;
  for (const ContactPoint& contact : FindContacts(path, 0.2)) {
    if (std::abs(contact.point_in_site.x()) < 4) continue;  // the bend begins
    EXPECT_NEAR(contact.point_in_site.z(), 0, 0.001) << contact.point_in_site.transpose();
  }
}

TEST(EstimateSuspension, WithoutHeightsThereIsNone) {
  const SuspensionFit fit = EstimateSuspension(LeaningPath(kRoll), {});
  EXPECT_EQ(fit.lean.roll, 0);
  EXPECT_EQ(fit.plane_errors, 1);
}

TEST(EstimateSuspension, LevelGroundIsAsFlatAsPlanesGet) {
  EXPECT_LT(EstimateSuspension(LeaningPath(0), LevelGround(1.2)).plane_errors, 0.2);
}

TEST(EstimateSuspension, PlanesErrByWhatTheLeanDoesNotExplain) {
  const double level = EstimateSuspension(LeaningPath(0), LevelGround(1.2)).plane_errors;
  EXPECT_LT(EstimateSuspension(LeaningPath(kRoll), LevelGround(1.2)).plane_errors, level + 0.05);
}

}  // namespace
}  // namespace parkade
