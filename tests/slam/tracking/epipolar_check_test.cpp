#include "slam/tracking/epipolar_check.h"

#include <gtest/gtest.h>

#include <random>

#include "core/rigid3.h"

namespace parkade {
namespace {

constexpr double kRadiansPerPixel = 1.0 / 400;

struct Scene {
  std::vector<BearingPair> pairs;
  std::vector<bool> is_static;
};

/// 150 points 2 to 30 m all around; the first `num_moving` of them moved on their own.
Scene MakeScene(const Rigid3& now_from_last, size_t num_moving,
                const Eigen::Vector3d& their_motion) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::normal_distribution<double> noise(0, 0.3 * kRadiansPerPixel);
  Scene scene;
  while (scene.pairs.size() < 150) {
    const Eigen::Vector3d direction(uniform(random), uniform(random), uniform(random));
    if (direction.norm() > 1 || direction.norm() < 0.2 || direction.z() < -0.2 * direction.norm())
      continue;
    const Eigen::Vector3d point = direction.normalized() * (16 + 14 * uniform(random));
    const bool is_static = scene.pairs.size() >= num_moving;
    Eigen::Vector3d now =
        now_from_last * point + (is_static ? Eigen::Vector3d::Zero() : their_motion);
    now = now.normalized() + Eigen::Vector3d(noise(random), noise(random), noise(random));
    scene.pairs.push_back({point.normalized(), now.normalized(), kRadiansPerPixel});
    scene.is_static.push_back(is_static);
  }
  return scene;
}

size_t CountAgreeing(const Scene& scene, const EpipolarCheck& check, bool is_static) {
  size_t count = 0;
  for (size_t i = 0; i < scene.pairs.size(); ++i)
    count += scene.is_static[i] == is_static && check.agrees[i];
  return count;
}

TEST(CheckEpipolarGeometry, MovingThingsAreRefusedAndTheStaticWorldKept) {
  const Rigid3 now_from_last{ExpSo3({0.01, -0.03, 0.005}), {0.05, 0, -0.6}};
  const Scene scene = MakeScene(now_from_last, 45, {0.6, -0.7, 0.2});

  const EpipolarCheck check =
      CheckEpipolarGeometry(scene.pairs, now_from_last.rotation.toRotationMatrix(), 1.5);

  EXPECT_TRUE(check.is_trusted);
  EXPECT_GE(CountAgreeing(scene, check, true), 100u) << "of 105";
  EXPECT_LE(CountAgreeing(scene, check, false), 9u) << "of 45: some move along their epipolar line";
  EXPECT_GT(check.direction.dot(now_from_last.translation.normalized()), std::cos(0.03));
}

TEST(CheckEpipolarGeometry, AGyroBiasIsRefinedAway) {
  const Rigid3 now_from_last{ExpSo3({0.01, -0.03, 0.005}), {0.3, 0, -0.3}};
  const Scene scene = MakeScene(now_from_last, 30, {0.8, -0.9, 0.2});
  const Eigen::Matrix3d predicted =
      (ExpSo3({0.012, 0.01, -0.01}) * now_from_last.rotation).toRotationMatrix();

  const EpipolarCheck check = CheckEpipolarGeometry(scene.pairs, predicted, 1.5);

  EXPECT_GE(CountAgreeing(scene, check, true), 114u) << "of 120";
  const Eigen::Quaterniond found(check.now_from_last);
  EXPECT_LT(found.angularDistance(now_from_last.rotation), 0.001);
}

TEST(CheckEpipolarGeometry, StandstillAndPureRotationKeepEverything) {
  for (const Eigen::Vector3d& turn :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.02, -0.1, 0.01)}) {
    const Rigid3 now_from_last{ExpSo3(turn), {0, 0, 0}};
    const Scene scene = MakeScene(now_from_last, 0, {0, 0, 0});

    const EpipolarCheck check =
        CheckEpipolarGeometry(scene.pairs, now_from_last.rotation.toRotationMatrix(), 1.5);

    EXPECT_TRUE(check.is_trusted);
    EXPECT_GE(CountAgreeing(scene, check, true), 149u) << "turn " << turn.transpose();
  }
}

TEST(CheckEpipolarGeometry, SomethingThatComesBackwardsAlongItsEpipolarLineIsRefused) {
  const Rigid3 now_from_last{ExpSo3({0, 0, 0}), {0, 0, -0.5}};
  const Scene scene =
      MakeScene(now_from_last, 20, {0, 0, 2.0});  // drives away from us, faster than we do

  const EpipolarCheck check = CheckEpipolarGeometry(scene.pairs, Eigen::Matrix3d::Identity(), 1.5);

  EXPECT_GE(CountAgreeing(scene, check, true), 125u) << "of 130";
  EXPECT_LE(CountAgreeing(scene, check, false), 2u) << "of 20";
}

TEST(CheckEpipolarGeometry, FewPairsAndNonsenseAreNotTrustedAndNotRefused) {
  Scene scene = MakeScene({}, 0, {0, 0, 0});
  std::mt19937 random(9);
  std::shuffle(scene.pairs.begin(), scene.pairs.end(), random);
  std::vector<BearingPair> nonsense = scene.pairs;
  for (size_t i = 0; i < nonsense.size(); ++i)
    nonsense[i].now = scene.pairs[(i + 11) % nonsense.size()].now;

  const EpipolarCheck check = CheckEpipolarGeometry(nonsense, Eigen::Matrix3d::Identity(), 1.5);
  const EpipolarCheck few = CheckEpipolarGeometry({scene.pairs.begin(), scene.pairs.begin() + 5},
                                                  Eigen::Matrix3d::Identity(), 1.5);
  const EpipolarCheck none = CheckEpipolarGeometry({}, Eigen::Matrix3d::Identity(), 1.5);

  EXPECT_FALSE(check.is_trusted);
  EXPECT_EQ(std::count(check.agrees.begin(), check.agrees.end(), true), 150);
  EXPECT_FALSE(few.is_trusted);
  EXPECT_EQ(few.agrees.size(), 5u);
  EXPECT_TRUE(none.agrees.empty());
}

TEST(CheckEpipolarGeometry, TheSameInputGivesTheSameAnswer) {
  const Rigid3 now_from_last{ExpSo3({0.01, -0.03, 0.005}), {0.05, 0, -0.6}};
  const Scene scene = MakeScene(now_from_last, 45, {0.6, -0.7, 0.2});

  const EpipolarCheck first = CheckEpipolarGeometry(scene.pairs, Eigen::Matrix3d::Identity(), 1.5);
  const EpipolarCheck second = CheckEpipolarGeometry(scene.pairs, Eigen::Matrix3d::Identity(), 1.5);

  EXPECT_EQ(first.agrees, second.agrees);
  EXPECT_EQ(first.now_from_last, second.now_from_last);
}

}  // namespace
}  // namespace parkade
