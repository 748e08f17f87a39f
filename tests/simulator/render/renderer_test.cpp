#include "tests/simulator/render/renderer.h"

#include <gtest/gtest.h>

#include <array>
#include <opencv2/imgproc.hpp>

#include "core/parallel.h"
#include "tests/simulator/drives/plan_drive.h"
#include "tests/simulator/render/image_sensor.h"
#include "tests/simulator/scenes/build_scene.h"
#include "tests/simulator/tracks/kept_tracks.h"
#include "tests/simulator/vehicle/simulated_rig.h"

namespace parkade::simulator {
namespace {

class LotImages : public testing::Test {
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

  static RenderedImage Take(size_t camera, double time, Semantics semantics) {
    return renderer_->Render(
        {camera, [=](double offset) { return plan_->motion.WorldFromBody(time + offset); }, 0.003,
         semantics});
  }

  static inline Scene* scene_ = nullptr;
  static inline Rig* rig_ = nullptr;
  static inline Renderer* renderer_ = nullptr;
  static inline DrivePlan* plan_ = nullptr;
};

TEST_F(LotImages, MostTracksSurviveFromFrameToFrameWhileDriving) {
  for (size_t camera = 0; camera < 4; ++camera) {
    ImageSensor sensor({}, camera);
    cv::Mat gray[2];
    for (int i = 0; i < 2; ++i)
      cv::cvtColor(sensor.Develop(Take(camera, 8 + 0.1 * i, Semantics::kNone).radiance), gray[i],
                   cv::COLOR_BGR2GRAY);
    const FollowedCorners tracks =
        FollowCorners(gray[0], gray[1], renderer_->Mask(camera), {.quality = 0.005, .spacing = 10});
    ASSERT_GE(tracks.num_corners(), 150) << camera;
    EXPECT_GE(tracks.num_kept(), 0.75 * tracks.num_corners()) << camera;
  }
}

/// Pixels are drivable by the half, so that nothing is said of rims of 10 cm, nor of what is so far
/// that a pixel is long.
TEST_F(LotImages, NoUndrivablePlaceOfThePlanIsMarkedAsDrivable) {
  constexpr double kRim = 0.1, kReach = 12;  // [m]
  const double time = 12;
  const GroundSheet& sheet = scene_->place.ground.sheets()[0];
  const auto is_far_from_drivable = [&](double x, double y) {
    for (const double dx : {-kRim, 0.0, kRim})
      for (const double dy : {-kRim, 0.0, kRim})
        if (scene_->place.is_drivable(0, {x + dx, y + dy})) return false;
    return true;
  };
  for (size_t camera = 0; camera < 4; ++camera) {
    const cv::Mat drivable = Take(camera, time, Semantics::kDrivable).mask,
                  mask = renderer_->Mask(camera);
    cv::Mat inner;
    cv::erode(drivable, inner, cv::getStructuringElement(cv::MORPH_RECT, {3, 3}));
    const Rigid3 world_from_camera =
        plan_->motion.WorldFromBody(time) * rig_->cameras[camera].body_from_camera;
    const Rigid3 camera_from_world = world_from_camera.Inverse();
    const Eigen::Vector2d eye = world_from_camera.translation.head<2>();
    int num_wrong = 0, num_checked = 0;
    for (double x = 0.5; x < sheet.max.x(); x += 0.31) {
      for (double y = 0.5; y < sheet.max.y(); y += 0.31) {
        if ((Eigen::Vector2d(x, y) - eye).norm() > kReach || !is_far_from_drivable(x, y)) continue;
        const auto pixel = rig_->cameras[camera].model.Project(
            camera_from_world * Eigen::Vector3d(x, y, sheet.height({x, y})));
        if (!pixel || !rig_->cameras[camera].model.IsInImage(*pixel, 2)) continue;
        const cv::Point place(static_cast<int>(std::lround(pixel->x())),
                              static_cast<int>(std::lround(pixel->y())));
        if (mask.at<std::uint8_t>(place) == 0) continue;
        num_wrong += inner.at<std::uint8_t>(place) == 255;
        ++num_checked;
      }
    }
    EXPECT_GT(num_checked, 100);
    EXPECT_LE(num_wrong, 0.001 * num_checked)
        << camera << ": " << num_wrong << " of " << num_checked;
    EXPECT_GT(cv::countNonZero(drivable), 20000) << camera;
  }
}

TEST_F(LotImages, LevelGroundIsWhatIsDrivableAndIslandsBesides) {
  for (size_t camera = 0; camera < 4; ++camera) {
    const Shot shot{
        .camera = camera,
        .world_from_body = [](double offset) { return plan_->motion.WorldFromBody(12 + offset); },
        .semantics = Semantics::kLevelGround};
    const cv::Mat level = renderer_->Render(shot).mask,
                  drivable = Take(camera, 12, Semantics::kDrivable).mask;
    cv::Mat missing, more;
    cv::subtract(drivable, level, missing);
    cv::subtract(level, drivable, more);
    EXPECT_EQ(cv::countNonZero(missing), 0) << camera;
    EXPECT_GT(cv::countNonZero(more), 200) << camera;
    EXPECT_LT(cv::countNonZero(more), cv::countNonZero(drivable)) << camera;
  }
}

TEST_F(LotImages, ClassesTellDrivableGroundFromTheRest) {
  std::array<int, kNumSurfaceClasses> seen{};
  int num_unlike = 0, num_drivable = 0;
  for (size_t camera = 0; camera < 4; ++camera) {
    const cv::Mat classes = Take(camera, 12, Semantics::kClasses).mask,
                  drivable = Take(camera, 12, Semantics::kDrivable).mask;
    for (int row = 0; row < classes.rows; ++row)
      for (int column = 0; column < classes.cols; ++column) {
        const std::uint8_t found = classes.at<std::uint8_t>(row, column);
        const bool is_drivable = found <= static_cast<int>(SurfaceClass::kMarking);
        num_unlike += is_drivable != (drivable.at<std::uint8_t>(row, column) == 255);
        num_drivable += is_drivable;
        if (found < kNumSurfaceClasses) ++seen[found];
      }
  }
  EXPECT_LT(num_unlike, 0.01 * num_drivable);
  for (const SurfaceClass expected :
       {SurfaceClass::kDrivable, SurfaceClass::kMarking, SurfaceClass::kVegetation,
        SurfaceClass::kKerb, SurfaceClass::kVehicle, SurfaceClass::kStructure,
        SurfaceClass::kOwnCar})
    EXPECT_GT(seen[static_cast<size_t>(expected)], 100) << static_cast<int>(expected);
}

TEST_F(LotImages, TheOwnCarIsMaskedAndDoesNotMove) {
  for (size_t camera = 0; camera < 4; ++camera) {
    const cv::Mat mask = renderer_->Mask(camera);
    const int num_masked = mask.rows * mask.cols - cv::countNonZero(mask);
    EXPECT_GT(num_masked, 0.05 * mask.rows * mask.cols) << camera;
    EXPECT_LT(num_masked, 0.5 * mask.rows * mask.cols) << camera;
    const cv::Mat drivable = Take(camera, 20, Semantics::kDrivable).mask;
    cv::Mat hidden;
    cv::bitwise_and(drivable, mask == 0, hidden);
    // Erosion masks a rim of two pixels that still shows ground.
    EXPECT_LT(cv::countNonZero(hidden), 6000) << camera;
  }
}

TEST_F(LotImages, TheSameImageComesOutTwice) {
  const cv::Mat first = Take(1, 9, Semantics::kNone).radiance,
                second = Take(1, 9, Semantics::kNone).radiance;
  EXPECT_EQ(cv::norm(first, second, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace parkade::simulator
