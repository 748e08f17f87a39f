#include <gtest/gtest.h>

#include <algorithm>

#include "tests/simulator/drives/plan_drive.h"
#include "tests/simulator/drives/presets.h"
#include "tests/simulator/layouts/parking_maneuver.h"
#include "tests/simulator/layouts/plan_place.h"
#include "tests/simulator/rays/ray_scene.h"
#include "tests/simulator/scenes/build_scene.h"
#include "tests/simulator/scenes/traffic.h"
#include "tests/simulator/sensors/imu_integration.h"

namespace parkade::simulator {
namespace {

/// Points of the own car's outline in body, a hand's breadth apart.
std::vector<Eigen::Vector2d> OutlinePoints() {
  constexpr double kStep = 0.1;  // [m]
  const CarOutline outline = OwnCarOutline();
  std::vector<Eigen::Vector2d> points;
  for (double x = outline.rear; x <= outline.front; x += kStep)
    for (const double y : {-outline.half_width, outline.half_width}) points.emplace_back(x, y);
  for (double y = -outline.half_width; y <= outline.half_width; y += kStep)
    for (const double x : {outline.rear, outline.front}) points.emplace_back(x, y);
  return points;
}

/// Whether something stands between the corners of the own car, at the height of bumpers, doors and
/// windows.
bool IsHit(const RayScene& objects, const Rigid3& world_from_body) {
  const CarOutline outline = OwnCarOutline();
  const Eigen::Vector2d corners[] = {{outline.front, outline.half_width},
                                     {outline.rear, outline.half_width},
                                     {outline.rear, -outline.half_width},
                                     {outline.front, -outline.half_width}};
  for (const double height : {0.35, 0.8, 1.3}) {
    for (int edge = 0; edge < 6; ++edge) {  // the four sides and the diagonals
      const int to = edge < 4 ? (edge + 1) % 4 : edge - 2, from = edge < 4 ? edge : edge - 4;
      const Eigen::Vector3d begin = world_from_body *
                                    Eigen::Vector3d(corners[from].x(), corners[from].y(), height),
                            end = world_from_body *
                                  Eigen::Vector3d(corners[to].x(), corners[to].y(), height);
      const Eigen::Vector3f origin = begin.cast<float>(), way = (end - begin).cast<float>();
      RTCRay ray{};
      ray.org_x = origin.x(), ray.org_y = origin.y(), ray.org_z = origin.z();
      ray.dir_x = way.x(), ray.dir_y = way.y(), ray.dir_z = way.z();
      ray.tfar = 1;
      ray.mask = ~0u;
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      rtcOccluded1(objects.scene(), &context, &ray);
      if (ray.tfar < 0) return true;
    }
  }
  return false;
}

DrivePlan PlanOf(const Place& place, const SimulateOptions& options) {
  return PlanDrive(place, options.drive, options.duration,
                   static_cast<std::uint64_t>(options.seed));
}

/// From the true start, over ten seconds, at the rate of the drive's own samples.
void ExpectThatAnIdealImuIntegratesToTheTruth(const SimulateOptions& options,
                                              const DrivePlan& plan) {
  const Rigid3 body_from_imu =
      MakeSimulatedRig(options.rig, static_cast<std::uint64_t>(options.seed)).body_from_imu;
  double worst = 0;
  for (double start = 0; start + 10 < plan.motion.Duration(); start += 2)
    worst = std::max(
        worst, IntegrationError(plan.motion, body_from_imu, start, 10, options.sensors.imu_rate));

  EXPECT_LT(worst, 0.05);
  testing::Test::RecordProperty("worst_imu_m", std::to_string(worst));
}

void ExpectThatTheWholeCarStaysOnDrivableGround(const Place& place, const DrivePlan& plan) {
  const std::vector<Eigen::Vector2d> outline = OutlinePoints();
  for (double time = 0; time < plan.motion.Duration(); time += 0.1) {
    const Rigid3 world_from_body = plan.motion.WorldFromBody(time);
    for (const Eigen::Vector2d& point : outline) {
      const Eigen::Vector3d at = world_from_body * Eigen::Vector3d(point.x(), point.y(), 0);
      ASSERT_TRUE(place.is_drivable(place.ground.SheetAt(at.head<2>(), at.z()), at.head<2>()))
          << "at " << time << " s, " << at.transpose();
    }
  }
}

void ExpectThatTrafficKeepsClear(const SimulateOptions& options, const Place& place,
                                 const DrivePlan& plan) {
  Scene scene{.place = place, .sky = Sky(1)};
  AddTraffic(scene, plan.motion, options.traffic, static_cast<std::uint64_t>(options.seed));
  double nearest = 1e9;
  for (double time = 0; time < plan.motion.Duration(); time += 0.1)
    nearest = std::min(nearest, TrafficClearance(scene, plan.motion, time));

  EXPECT_GT(nearest, 0.5);
  EXPECT_GE(scene.movers.movers.size(), static_cast<size_t>(options.traffic));
  testing::Test::RecordProperty("nearest_m", std::to_string(nearest));
}

/// The drives of the quick suite, as they are planned.
class QuickDrive : public testing::TestWithParam<const char*> {
 protected:
  const SimulateOptions options_ = QuickForm(FindPreset(GetParam())->options);
  const Place place_ = PlanPlace(options_.scene, options_.OfScene());
  const DrivePlan plan_ = PlanOf(place_, options_);
};

TEST_P(QuickDrive, IsTrueToItsImuAndTouchesNobody) {
  ExpectThatAnIdealImuIntegratesToTheTruth(options_, plan_);
  ExpectThatTheWholeCarStaysOnDrivableGround(place_, plan_);
  ExpectThatTrafficKeepsClear(options_, place_, plan_);
}

std::vector<const char*> AllPresets() {
  std::vector<const char*> names;
  for (const Preset& preset : Presets()) names.push_back(preset.name.c_str());
  return names;
}

std::string TitleOf(const testing::TestParamInfo<const char*>& info) {
  std::string title = info.param;
  std::replace(title.begin(), title.end(), '-', '_');
  return title;
}

INSTANTIATE_TEST_SUITE_P(Suite, QuickDrive, testing::ValuesIn(AllPresets()), TitleOf);

/// Points that are really there to be seen: on walls, pillars, poles, parked cars.
class DriveThroughObjects : public QuickDrive {};

TEST_P(DriveThroughObjects, TheCarTouchesNothing) {
  SceneOptions coarse = options_.OfScene();
  coarse.ground_texel = 0.2;
  const Scene scene = BuildScene(options_.scene, coarse);
  const RayScene objects({&scene.objects});

  for (double time = 0; time < plan_.motion.Duration(); time += 0.1)
    ASSERT_FALSE(IsHit(objects, plan_.motion.WorldFromBody(time)))
        << "at " << time << " s, " << plan_.motion.WorldFromBody(time).translation.transpose();
  // The first thing beside the way would be noticed.
  bool is_any_hit = false;
  for (double aside = 0; aside < 60; aside += 0.5) {
    Rigid3 beside = plan_.motion.WorldFromBody(0);
    beside.translation += beside.rotation * Eigen::Vector3d(0, aside, 0);
    is_any_hit = is_any_hit || IsHit(objects, beside);
  }
  EXPECT_TRUE(is_any_hit);
}

INSTANTIATE_TEST_SUITE_P(Suite, DriveThroughObjects,
                         testing::Values("out3", "out4", "out8", "out15", "in0", "in3"), TitleOf);

}  // namespace
}  // namespace parkade::simulator
