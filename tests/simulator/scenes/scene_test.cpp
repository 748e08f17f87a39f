#include "tests/simulator/scenes/scene.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <set>

#include "core/parallel.h"
#include "tests/simulator/drives/plan_drive.h"
#include "tests/simulator/layouts/plan_place.h"
#include "tests/simulator/rays/ray_scene.h"
#include "tests/simulator/render/image_sensor.h"
#include "tests/simulator/render/renderer.h"
#include "tests/simulator/scenes/build_scene.h"
#include "tests/simulator/scenes/traffic.h"
#include "tests/simulator/sinks/truth_files.h"
#include "tests/simulator/tracks/kept_tracks.h"
#include "tests/simulator/vehicle/simulated_rig.h"

namespace parkade::simulator {
namespace {

/// A drive through a scene, and images of it. Coarse ground paint: quick to make.
struct DrivenScene {
  Scene scene;
  DrivePlan plan;
  Rig rig;
  std::unique_ptr<Renderer> renderer;

  DrivenScene(const std::string& name, const SceneOptions& options, int traffic)
      : scene(BuildScene(name, options)),
        plan(PlanDrive(scene.place, 40, options.seed)),
        rig(MakeSimulatedRig({}, options.seed)) {
    AddTraffic(scene, plan.motion, traffic, options.seed);
    renderer = std::make_unique<Renderer>(scene, rig, kHalfFieldOfView);
  }

  RenderedImage Take(size_t camera, double time) const {
    Shot shot;
    shot.camera = camera;
    shot.world_from_body = [this, time](double offset) {
      return plan.motion.WorldFromBody(time + offset);
    };
    shot.exposure = scene.usual_exposure;
    shot.semantics = Semantics::kDrivable;
    shot.time = time;
    return renderer->Render(shot);
  }
};

/// How many of 200 corners are followed into the image 50 ms later and back to where they were.
int NumKeptTracks(const DrivenScene& driven, size_t camera, double time) {
  ImageSensor sensor({.exposure = driven.scene.usual_exposure}, camera);
  cv::Mat gray[2];
  for (int i = 0; i < 2; ++i)
    cv::cvtColor(sensor.Develop(driven.Take(camera, time + 0.05 * i).radiance), gray[i],
                 cv::COLOR_BGR2GRAY);
  const FollowedCorners tracks = FollowCorners(gray[0], gray[1], driven.renderer->Mask(camera));
  EXPECT_GE(tracks.num_corners(), 195) << camera;
  return tracks.num_kept();
}

/// Whether something that stands there hides a point of the ground from a camera.
bool IsHidden(const RayScene& objects, const Eigen::Vector3d& eye, const Eigen::Vector3d& point) {
  constexpr float kAlmost = 0.995f;  // of the way
  const Eigen::Vector3f origin = eye.cast<float>(), way = (point - eye).cast<float>();
  RTCRay ray{};
  ray.org_x = origin.x(), ray.org_y = origin.y(), ray.org_z = origin.z();
  ray.dir_x = way.x(), ray.dir_y = way.y(), ray.dir_z = way.z();
  ray.tfar = kAlmost;
  ray.mask = ~0u;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(objects.scene(), &context, &ray);
  return ray.tfar < 0;
}

bool IsNearRim(const Place& place, size_t sheet, const Eigen::Vector2d& xy) {
  constexpr double kCell = 0.05;  // [m]
  for (const double dx : {-kCell, 0.0, kCell})
    for (const double dy : {-kCell, 0.0, kCell})
      if (place.is_drivable(sheet, xy + Eigen::Vector2d(dx, dy)) != place.is_drivable(sheet, xy))
        return true;
  return false;
}

/// Looks at places on drivable ground within 4 m of a camera that nothing hides, and at undrivable
/// ones within 8 m. Returns the share that the mask has right, give or take a pixel and the cell of
/// 5 cm that the renderer looks up.
double MaskAgreement(const DrivenScene& driven, size_t camera, double time) {
  const cv::Mat drivable = driven.Take(camera, time).mask, mask = driven.renderer->Mask(camera);
  const cv::Mat neighbors = cv::getStructuringElement(cv::MORPH_RECT, {3, 3});
  cv::Mat inner, outer;
  cv::erode(drivable, inner, neighbors);
  cv::dilate(drivable, outer, neighbors);
  const Rigid3 world_from_body = driven.plan.motion.WorldFromBody(time);
  const Rigid3 camera_from_world =
      (world_from_body * driven.rig.cameras[camera].body_from_camera).Inverse();
  const Eigen::Vector3d camera_place =
      world_from_body * driven.rig.cameras[camera].body_from_camera.translation;
  const Eigen::Vector2d eye = camera_place.head<2>();
  const RayScene objects({&driven.scene.objects});
  const Ground& ground = driven.scene.place.ground;
  int num_right = 0, num_checked = 0;
  for (double dx = -8; dx < 8; dx += 0.37) {
    for (double dy = -8; dy < 8; dy += 0.37) {
      const Eigen::Vector2d xy = eye + Eigen::Vector2d(dx, dy);
      const double near_z = world_from_body.translation.z();
      const size_t sheet = ground.SheetAt(xy, near_z);
      if (!ground.sheets()[sheet].Covers(xy)) continue;
      const bool is_road = driven.scene.place.is_drivable(sheet, xy);
      if (IsNearRim(driven.scene.place, sheet, xy)) continue;
      const Eigen::Vector3d point(xy.x(), xy.y(), ground.Height(xy, near_z));
      const auto pixel = driven.rig.cameras[camera].model.Project(camera_from_world * point);
      if (!pixel || !driven.rig.cameras[camera].model.IsInImage(*pixel, 2)) continue;
      const cv::Point place(static_cast<int>(std::lround(pixel->x())),
                            static_cast<int>(std::lround(pixel->y())));
      if (mask.at<std::uint8_t>(place) == 0) continue;
      if (is_road && (std::hypot(dx, dy) > 4 || IsHidden(objects, camera_place, point))) continue;
      num_right +=
          is_road ? outer.at<std::uint8_t>(place) == 255 : inner.at<std::uint8_t>(place) == 0;
      ++num_checked;
    }
  }
  EXPECT_GT(num_checked, 40) << camera;
  return static_cast<double>(num_right) / std::max(1, num_checked);
}

struct SceneCase {
  const char* title;
  const char* name;
  SceneOptions options;
  std::array<double, 2> moments;  ///< [s] while it drives
};

class DrivenScenes : public testing::TestWithParam<SceneCase> {
 protected:
  void SetUp() override { SetNumThreads(2); }
};

/// One test a scene: to build one is what takes the time.
TEST_P(DrivenScenes, TracksSurviveMasksMatchTheGroundAndTheBytesRepeat) {
  const SceneCase& wanted = GetParam();
  const DrivenScene driven(wanted.name, wanted.options, 2);
  for (const double time : wanted.moments) {
    ASSERT_GT(driven.plan.motion.At(time).velocity_in_world.norm(), 1.5);
    for (size_t camera = 0; camera < 4; ++camera)
      EXPECT_GE(NumKeptTracks(driven, camera, time), 150)
          << wanted.title << " camera " << camera << " at " << time;
  }
  for (size_t camera = 0; camera < 4; ++camera)
    EXPECT_GT(MaskAgreement(driven, camera, wanted.moments[0]), 0.97)
        << wanted.title << " camera " << camera;
  const RenderedImage first = driven.Take(1, 9), second = driven.Take(1, 9);
  EXPECT_EQ(cv::norm(first.radiance, second.radiance, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(first.mask, second.mask, cv::NORM_INF), 0);
}

INSTANTIATE_TEST_SUITE_P(
    Worlds, DrivenScenes,
    testing::Values(
        SceneCase{"lot_wet", "lot", {.seed = 5, .ground_texel = 0.015, .weather = "wet"}, {8, 28}},
        SceneCase{"garage", "garage", {.seed = 5, .ground_texel = 0.015}, {18, 21}},
        SceneCase{"street", "street", {.seed = 5, .ground_texel = 0.012}, {9, 15}},
        SceneCase{"street_dusk",
                  "street",
                  {.seed = 5, .ground_texel = 0.012, .weather = "dusk"},
                  {9, 15}},
        SceneCase{
            "lot_dusk", "lot", {.seed = 5, .ground_texel = 0.015, .weather = "dusk"}, {8, 28}}),
    [](const auto& info) { return std::string(info.param.title); });

class SurfaceTruth : public testing::TestWithParam<const char*> {};

TEST_P(SurfaceTruth, TheMeshThatIsSeenAndThePlyLieOnTheGround) {
  const SceneOptions options{.seed = 2, .ground_texel = 0.1, .speed_bumps = 2};
  const Scene scene = BuildScene(GetParam(), options);

  double worst = 0;
  for (size_t i = 0; i < scene.ground.triangles.size(); ++i) {
    const auto& [a, b, c] = scene.ground.triangles[i];
    const Eigen::Vector3d center =
        ((scene.ground.positions[a] + scene.ground.positions[b] + scene.ground.positions[c]) / 3)
            .cast<double>();
    const GroundSheet& sheet = scene.place.ground.sheets()[scene.ground.triangle_materials[i]];
    worst = std::max(worst, std::abs(sheet.height(center.head<2>()) - center.z()));
  }
  EXPECT_LT(worst, 0.001);

  const TriangleMesh truth = DrivableSurface(scene.place);
  double worst_truth = 0;
  for (const Eigen::Vector3f& vertex : truth.vertices) {
    double nearest = 1e9;
    for (const GroundSheet& sheet : scene.place.ground.sheets())
      nearest = std::min(nearest, std::abs(sheet.height(vertex.head<2>().cast<double>()) -
                                           vertex.cast<double>().z()));
    worst_truth = std::max(worst_truth, nearest);
  }
  EXPECT_LT(worst_truth, 1e-5);
  EXPECT_GT(SurfaceArea(truth), 1000);
}

TEST_P(SurfaceTruth, IsTheDrivableGroundAtTheMiddlesOfItsSquaresAndHasNoGapBetweenSheets) {
  constexpr int kPerMeter = 10;
  const Place place =
      PlanPlace(GetParam(), {.seed = 90});  // whose half circles begin between two squares
  const TriangleMesh truth = DrivableSurface(place);
  std::set<std::pair<int, int>> squares;
  for (const auto& [a, b, c] : truth.triangles) {
    const Eigen::Vector2f corner =
        truth.vertices[a].head<2>();  // of both triangles of a square the lowest one
    squares.emplace(std::lround(kPerMeter * corner.x()), std::lround(kPerMeter * corner.y()));
  }
  Eigen::AlignedBox2d box;
  for (const GroundSheet& sheet : place.ground.sheets()) box.extend(sheet.min).extend(sheet.max);
  const auto is_drivable = [&](const Eigen::Vector2d& point) {
    for (size_t i = 0; i < place.ground.sheets().size(); ++i)
      if (place.ground.sheets()[i].Covers(point) && place.is_drivable(i, point)) return true;
    return false;
  };
  size_t num_wrong = 0;
  for (int x = static_cast<int>(kPerMeter * box.min().x()) - 2; x < kPerMeter * box.max().x() + 2;
       ++x)
    for (int y = static_cast<int>(kPerMeter * box.min().y()) - 2; y < kPerMeter * box.max().y() + 2;
         ++y) {
      const Eigen::Vector2d middle = Eigen::Vector2d(x + 0.5, y + 0.5) / kPerMeter;
      const bool expected = is_drivable(middle);
      const bool is_tie = is_drivable(middle.array() - 1e-9) != is_drivable(middle.array() + 1e-9);
      num_wrong += !is_tie && expected != squares.contains({x, y});
    }
  EXPECT_EQ(num_wrong, 0u);
}

TEST_P(SurfaceTruth, KerbsBoundTheGroundThatLiesLeftOfThem) {
  const Scene scene = BuildScene(GetParam(), {.seed = 2, .ground_texel = 0.2});
  const Place& place = scene.place;
  const auto is_drivable = [&](const Eigen::Vector2d& point) {
    for (size_t i = 0; i < place.ground.sheets().size(); ++i)
      if (place.ground.sheets()[i].Covers(point) && place.is_drivable(i, point)) return true;
    return false;
  };
  ASSERT_GT(scene.kerbs.size(), 50u);
  size_t num_left = 0, num_right = 0;
  for (const KerbStone& stone : scene.kerbs) {
    const Eigen::Vector2d begin = stone.begin.head<2>(), along = stone.end.head<2>() - begin;
    const Eigen::Vector2d left = Eigen::Vector2d(-along.y(), along.x()).normalized();
    num_left += is_drivable(begin + 0.5 * along + 0.1 * left);
    num_right += is_drivable(begin + 0.5 * along - 0.1 * left);
    EXPECT_NEAR(stone.height, 0.114, 0.0061);
    EXPECT_NEAR(stone.begin.z(), place.ground.Height(begin, stone.begin.z()), 1e-9);
  }
  EXPECT_LT(num_right, 0.01 * static_cast<double>(scene.kerbs.size()))
      << "in the corners of squares that bends cross";
  EXPECT_GT(num_left, 0.8 * static_cast<double>(scene.kerbs.size())) << "cars stand at some";
}

INSTANTIATE_TEST_SUITE_P(Worlds, SurfaceTruth, testing::Values("lot", "garage", "street"));

/// The same drive by a car that nobody sees.
TEST(Scenes, ACarThatIsNotThereThrowsNoShadow) {
  const SceneOptions with_car{.seed = 5, .ground_texel = 0.1, .weather = "dry"};
  SceneOptions without = with_car;
  without.has_own_car = false;
  const DrivenScene driven("lot", with_car, 0), bare("lot", without, 0);
  cv::Mat light, bare_light;
  cv::cvtColor(driven.Take(1, 12).radiance, light, cv::COLOR_RGB2GRAY);
  cv::cvtColor(bare.Take(1, 12).radiance, bare_light, cv::COLOR_RGB2GRAY);
  const cv::Mat is_ground = driven.renderer->Mask(1);
  EXPECT_GT(cv::countNonZero((light < 0.8 * bare_light) & is_ground), 500);
  EXPECT_LT(cv::countNonZero((light > 1.05 * bare_light) & is_ground),
            0.002 * cv::countNonZero(is_ground));
}

TEST(Scenes, TheSunStandsAsHighAsIsAskedFor) {
  const Scene scene =
      BuildScene("lot", {.seed = 5, .ground_texel = 0.2, .weather = "dry", .sun_elevation = 12});
  EXPECT_NEAR(scene.sky.sun_direction().z(), std::sin(12 * M_PI / 180), 1e-6);
}

}  // namespace
}  // namespace parkade::simulator
