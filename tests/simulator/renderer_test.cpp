#include "tests/simulator/renderer.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "core/parallel.h"
#include "tests/simulator/image_sensor.h"
#include "tests/simulator/plan_drive.h"
#include "tests/simulator/simulated_rig.h"

namespace parkade::simulator {
namespace {

/// A white square plate: its centre and half its sides [m].
struct Marker {
  Eigen::Vector3d center, right, up;
};

/// Black ground and black walls around the car, before them white plates that face it.
struct MarkerWorld {
  std::vector<Marker> markers;
  Scene scene{.place = {},
              .sky = Sky(1),
              .ground_colors = {GroundCanvas({-1, -1}, {1, 1}, 0.1)},
              .ground = {},
              .objects = {},
              .materials = {Material{.albedo = Gray(0)}, Material{.albedo = Gray(0.9f)}},
              .own_car = {},
              .movers = {},
              .lamps = {}};

  MarkerWorld() {
    scene.ground_colors[0].Finish();
    scene.ground.AddQuad({{{-50, -50, 0}, {50, -50, 0}, {50, 50, 0}, {-50, 50, 0}}}, 0);
    for (const double side : {-1.0, 1.0}) {
      scene.objects.AddBox({15 * side, 0, 5}, {0.1, 15, 7}, 0, 0);
      scene.objects.AddBox({0, 15 * side, 5}, {15, 0.1, 7}, 0, 0);
    }
    for (int i = 0; i < 36; ++i) {
      const double azimuth = 2 * M_PI * i / 36, distance = 5 + 0.7 * (i % 4);
      Add({1.3 + distance * std::cos(azimuth), distance * std::sin(azimuth), 0.35 + 0.6 * (i % 3)}, 0.022 * distance);
    }
  }

  void Add(const Eigen::Vector3d& center, double half) {
    const Eigen::Vector3d front = (Eigen::Vector3d(1.3, 0, 0.8) - center).normalized();
    const Eigen::Vector3d right = half * Eigen::Vector3d::UnitZ().cross(front).normalized();
    const Eigen::Vector3d up = front.cross(right);
    markers.push_back({center, right, up});
    scene.objects.AddQuad({center - right - up, center + right - up, center + right + up, center - right + up}, 1);
  }
};

/// Where light is, and how far around it to look [px].
struct Patch {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  double reach = 0;
};

/// Centre of the light within a patch, or nothing when too little of it is there.
std::optional<Eigen::Vector2d> LightIn(const cv::Mat& radiance, const Patch& patch) {
  constexpr double kHaze = 0.012;  // over black ground and walls
  const int reach = static_cast<int>(patch.reach) + 3;
  const int column = static_cast<int>(std::lround(patch.center.x())),
            row = static_cast<int>(std::lround(patch.center.y()));
  if (column < reach || row < reach || column + reach >= radiance.cols || row + reach >= radiance.rows)
    return std::nullopt;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double weights = 0;
  for (int y = row - reach; y <= row + reach; ++y) {
    for (int x = column - reach; x <= column + reach; ++x) {
      const double light = radiance.at<cv::Vec3f>(y, x)[1];
      if (light < kHaze) continue;
      sum += light * Eigen::Vector2d(x, y);
      weights += light;
    }
  }
  if (weights < 0.2) return std::nullopt;
  return Eigen::Vector2d(sum / weights);
}

/// Where a point of the world appears when the car drives and the shutter rolls.
std::optional<Eigen::Vector2d> Project(const RigCamera& camera, const std::function<Rigid3(double)>& world_from_body,
                                       const Eigen::Vector3d& point) {
  double offset = 0;
  std::optional<Eigen::Vector2d> pixel;
  for (int iteration = 0; iteration < 5; ++iteration) {
    pixel = camera.model.Project((world_from_body(offset) * camera.body_from_camera).Inverse() * point);
    if (!pixel) return std::nullopt;
    offset = camera.line_delay * (pixel->y() - (camera.model.height() - 1) / 2.0);
  }
  return pixel;
}

/// Centre of the picture of a whole marker: the mean over its cells, each by the area of its picture.
std::optional<Patch> ProjectMarker(const RigCamera& camera, const std::function<Rigid3(double)>& world_from_body,
                                   const Marker& marker) {
  constexpr int kCells = 6;
  std::array<std::array<Eigen::Vector2d, kCells + 1>, kCells + 1> grid;
  for (int i = 0; i <= kCells; ++i) {
    for (int j = 0; j <= kCells; ++j) {
      const Eigen::Vector3d offset = (2.0 * i / kCells - 1) * marker.right + (2.0 * j / kCells - 1) * marker.up;
      const auto pixel = Project(camera, world_from_body, marker.center + offset);
      if (!pixel) return std::nullopt;
      grid[static_cast<size_t>(i)][static_cast<size_t>(j)] = *pixel;
    }
  }
  Patch patch;
  double area_sum = 0;
  for (size_t i = 0; i < kCells; ++i) {
    for (size_t j = 0; j < kCells; ++j) {
      const Eigen::Vector2d a = grid[i + 1][j + 1] - grid[i][j], b = grid[i][j + 1] - grid[i + 1][j];
      const double area = std::abs(a.x() * b.y() - a.y() * b.x());
      patch.center += area / 4 * (grid[i][j] + grid[i + 1][j] + grid[i][j + 1] + grid[i + 1][j + 1]);
      area_sum += area;
    }
  }
  patch.center /= area_sum;
  patch.reach = (grid[0][0] - grid[kCells][kCells]).norm() / 2;
  return patch;
}

struct MarkerErrors {
  int count = 0;
  double worst = 0, sum_squares = 0;
};

MarkerErrors CompareMarkers(const MarkerWorld& world, const Rig& rig,
                            const std::function<Rigid3(double)>& world_from_body, double exposure) {
  const Renderer renderer(world.scene, rig, kHalfFieldOfView);
  MarkerErrors errors;
  for (size_t camera = 0; camera < rig.cameras.size(); ++camera) {
    const cv::Mat radiance = renderer.Render({camera, world_from_body, exposure, false}).radiance;
    for (const Marker& marker : world.markers) {
      const auto expected = ProjectMarker(rig.cameras[camera], world_from_body, marker);
      const auto ray = expected ? rig.cameras[camera].model.Unproject(expected->center) : std::nullopt;
      if (!ray || ray->z() < std::cos(1.4) || expected->reach > 12) continue;  // the rim is dark
      const auto seen = LightIn(radiance, *expected);
      if (!seen) continue;
      const double error = (*seen - expected->center).norm();
      errors.worst = std::max(errors.worst, error);
      errors.sum_squares += error * error;
      ++errors.count;
    }
  }
  return errors;
}

TEST(Renderer, AMarkerAppearsWhereTheCameraModelProjectsIt) {
  const MarkerWorld world;
  const Rig rig = MakeSimulatedRig({}, 4);
  const Rigid3 pose{ExpSo3({0.01, -0.02, 0.3}), {0.2, -0.1, 0.03}};
  const MarkerErrors errors = CompareMarkers(
      world, rig, [&](double) { return pose; }, 0);

  EXPECT_GT(errors.count, 40);
  EXPECT_LT(std::sqrt(errors.sum_squares / errors.count), 0.1);
  EXPECT_LT(errors.worst, 0.3);
}

TEST(Renderer, MotionAndRollingShutterMoveAMarkerAsTheTruthSays) {
  const MarkerWorld world;
  RigOptions options;
  options.line_delay = 5e-5;
  const Rig rig = MakeSimulatedRig(options, 4);
  const auto world_from_body = [](double offset) {
    return Rigid3{ExpSo3({0, 0, 0.3 + 0.5 * offset}), {5 * offset, 1 * offset, 0}};
  };
  const MarkerErrors errors = CompareMarkers(world, rig, world_from_body, 0.002);

  EXPECT_GT(errors.count, 40);
  EXPECT_LT(std::sqrt(errors.sum_squares / errors.count), 0.15);
}

class LotPictures : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    SetNumThreads(2);
    scene_ = new Scene(BuildScene("lot", {.seed = 5, .ground_texel = 0.02}));
    rig_ = new Rig(MakeSimulatedRig({}, 5));
    renderer_ = new Renderer(*scene_, *rig_, kHalfFieldOfView);
    plan_ = new DrivePlan(PlanDrive(scene_->place, 40, 5));
  }
  static void TearDownTestSuite() {
    delete plan_;
    delete renderer_;
    delete rig_;
    delete scene_;
  }

  static RenderedImage Take(size_t camera, double time, bool with_semantics) {
    return renderer_->Render(
        {camera, [=](double offset) { return plan_->motion.WorldFromBody(time + offset); }, 0.003, with_semantics});
  }

  static inline Scene* scene_ = nullptr;
  static inline Rig* rig_ = nullptr;
  static inline Renderer* renderer_ = nullptr;
  static inline DrivePlan* plan_ = nullptr;
};

TEST_F(LotPictures, MostTracksSurviveFromFrameToFrameWhileDriving) {
  for (size_t camera = 0; camera < 4; ++camera) {
    ImageSensor sensor({}, camera);
    cv::Mat gray[2];
    for (int i = 0; i < 2; ++i)
      cv::cvtColor(sensor.Develop(Take(camera, 8 + 0.1 * i, false).radiance), gray[i], cv::COLOR_BGR2GRAY);
    std::vector<cv::Point2f> corners, moved, back;
    cv::goodFeaturesToTrack(gray[0], corners, 200, 0.005, 10, renderer_->Mask(camera));
    ASSERT_GE(corners.size(), 150u) << camera;
    std::vector<std::uint8_t> found, found_back;
    cv::calcOpticalFlowPyrLK(gray[0], gray[1], corners, moved, found, cv::noArray());
    cv::calcOpticalFlowPyrLK(gray[1], gray[0], moved, back, found_back, cv::noArray());
    int num_kept = 0;
    for (size_t i = 0; i < corners.size(); ++i)
      num_kept += found[i] && found_back[i] && cv::norm(back[i] - corners[i]) < 1;
    EXPECT_GE(num_kept, 0.75 * static_cast<double>(corners.size())) << camera;
  }
}

TEST_F(LotPictures, TheDrivableMaskAgreesWithThePlanOfTheLot) {
  const double time = 12;
  for (size_t camera = 0; camera < 4; ++camera) {
    const cv::Mat drivable = Take(camera, time, true).drivable, mask = renderer_->Mask(camera);
    const Rigid3 camera_from_world =
        (plan_->motion.WorldFromBody(time) * rig_->cameras[camera].body_from_camera).Inverse();
    int num_wrong = 0, num_checked = 0;
    const GroundSheet& sheet = scene_->place.ground.sheets()[0];
    for (double x = 0.5; x < sheet.max.x(); x += 0.31) {
      for (double y = 0.5; y < sheet.max.y(); y += 0.31) {
        if (scene_->place.is_drivable(0, {x, y})) continue;
        // A place that is no drivable ground must not be marked, whatever stands on it.
        const auto pixel =
            rig_->cameras[camera].model.Project(camera_from_world * Eigen::Vector3d(x, y, sheet.height({x, y})));
        if (!pixel || !rig_->cameras[camera].model.IsInImage(*pixel, 2)) continue;
        const cv::Point place(static_cast<int>(std::lround(pixel->x())), static_cast<int>(std::lround(pixel->y())));
        if (mask.at<std::uint8_t>(place) == 0) continue;
        num_wrong += drivable.at<std::uint8_t>(place) == 255;
        ++num_checked;
      }
    }
    EXPECT_GT(num_checked, 100);
    EXPECT_LT(num_wrong, 0.05 * num_checked) << camera;  // places just beside a car's outline
    EXPECT_GT(cv::countNonZero(drivable), 20000) << camera;
  }
}

TEST_F(LotPictures, TheOwnCarIsMaskedAndDoesNotMove) {
  for (size_t camera = 0; camera < 4; ++camera) {
    const cv::Mat mask = renderer_->Mask(camera);
    const int num_masked = mask.rows * mask.cols - cv::countNonZero(mask);
    EXPECT_GT(num_masked, 0.05 * mask.rows * mask.cols) << camera;
    EXPECT_LT(num_masked, 0.5 * mask.rows * mask.cols) << camera;
    const cv::Mat drivable = Take(camera, 20, true).drivable;
    cv::Mat hidden;
    cv::bitwise_and(drivable, mask == 0, hidden);
    // Erosion masks a rim of two pixels that still shows ground.
    EXPECT_LT(cv::countNonZero(hidden), 6000) << camera;
  }
}

TEST_F(LotPictures, TheSamePictureComesOutTwice) {
  const cv::Mat first = Take(1, 9, false).radiance, second = Take(1, 9, false).radiance;
  EXPECT_EQ(cv::norm(first, second, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace parkade::simulator
