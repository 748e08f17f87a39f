#include "server/map_folder/point_views.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace parkade {
namespace {

constexpr int kWidth = 640, kHeight = 400;
constexpr double kSpeed = 4;  // [m/s] along x
const Eigen::Vector3d kPoint(12, 3, 0);

/// Looks to the front or to the left, 0.3 rad down.
Rigid3 BodyFromCamera(bool is_left) {
  Eigen::Matrix3d front;  // columns: the camera's x right, y down, z forward
  front << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Eigen::Matrix3d yaw =
      Eigen::AngleAxisd(is_left ? M_PI / 2 : 0, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Matrix3d down = Eigen::AngleAxisd(-0.3, Eigen::Vector3d::UnitX()).toRotationMatrix();
  return {Eigen::Quaterniond(yaw * front * down), {is_left ? 1.0 : 2.0, is_left ? 0.9 : 0, 1.2}};
}

/// Ten seconds along x with two fisheyes at 10 Hz, the car's yaw swinging.
DriveViews TenSeconds() {
  DriveViews drive;
  std::vector<TrajectoryState> states;
  for (int i = 0; i <= 200; ++i) {
    TrajectoryState& state = states.emplace_back();
    const double t = 0.05 * i;
    state.time = TimestampFromSeconds(t);
    state.world_from_body = {
        Eigen::Quaterniond(Eigen::AngleAxisd(0.3 * std::sin(t), Eigen::Vector3d::UnitZ())),
        {kSpeed * t, 0, 0.4}};
  }
  drive.site_from_imu = Trajectory(std::move(states));
  drive.rig.body_from_imu.translation = {0.5, 0, 0.4};
  for (const bool is_left : {false, true}) {
    RigCamera& camera = drive.rig.cameras.emplace_back();
    camera.name = is_left ? "cam1" : "cam0";
    camera.model =
        CameraModel(KannalaBrandtProjection{190, 190, 320, 200, 0.01, 0, 0, 0}, kWidth, kHeight);
    camera.body_from_camera = BodyFromCamera(is_left);
    camera.time_shift = is_left ? 0.013 : -0.02;
    CameraTimes& times = drive.cameras.emplace_back();
    times.name = camera.name;
    times.time_shift = 0.001;
    for (int i = 0; i < 100; ++i) times.times.push_back(TimestampFromSeconds(0.1 * i + 0.003));
  }
  return drive;
}

/// The slow and simple way: the pixel of one image, its row's time found in twenty rounds.
std::optional<Eigen::Vector2d> PixelIn(const DriveViews& drive, size_t camera, Timestamp time) {
  const RigCamera& model = drive.rig.cameras[camera];
  std::optional<Eigen::Vector2d> pixel;
  double row = (kHeight - 1) / 2.0;
  for (int round = 0; round < 20; ++round) {
    const double shift = model.time_shift - drive.cameras[camera].time_shift +
                         model.line_delay * (row - (kHeight - 1) / 2.0);
    const auto site_from_imu = drive.site_from_imu.At(time + shift);
    if (!site_from_imu) return std::nullopt;
    const Rigid3 site_from_camera =
        *site_from_imu * drive.rig.body_from_imu.Inverse() * model.body_from_camera;
    pixel = model.model.Project(site_from_camera.Inverse() * kPoint);
    if (!pixel) return std::nullopt;
    row = pixel->y();
  }
  return pixel;
}

void ExpectPixelsAsTheSlowWay(const DriveViews& drive, double tolerance_px) {
  const std::vector<PointView> views = FindPointViews(kPoint, drive, 100);
  ASSERT_GE(views.size(), 8u);
  for (const PointView& view : views) {
    const size_t camera = view.camera == "cam0" ? 0 : 1;
    const auto slow = PixelIn(drive, camera, view.time);
    ASSERT_TRUE(slow);
    EXPECT_LT((*slow - view.pixel).norm(), tolerance_px) << view.camera << view.time.ToSeconds();
  }
}

TEST(FindPointViews, PixelsAreThoseOfTheSlowWay) { ExpectPixelsAsTheSlowWay(TenSeconds(), 1e-6); }

TEST(FindPointViews, RowsOfARollingShutterHaveTheirOwnTimes) {
  DriveViews drive = TenSeconds();
  for (RigCamera& camera : drive.rig.cameras) camera.line_delay = 5e-5;

  ExpectPixelsAsTheSlowWay(drive, 0.05);
}

TEST(FindPointViews, NoImageThatSeesItBetterIsLeftOut) {
  const DriveViews drive = TenSeconds();
  const std::vector<PointView> views = FindPointViews(kPoint, drive, 100);

  for (size_t i = 1; i < views.size(); ++i) EXPECT_GE(views[i - 1].resolution, views[i].resolution);
  for (size_t camera = 0; camera < 2; ++camera)
    for (const Timestamp time : drive.cameras[camera].times) {
      const auto pixel = PixelIn(drive, camera, time);
      const double distance =
          (drive.site_from_imu.At(time).value_or(Rigid3{}).translation - kPoint).norm();
      if (!pixel || !drive.rig.cameras[camera].IsUsable(*pixel, 5) || distance > 25) continue;
      EXPECT_TRUE(std::any_of(views.begin(), views.end(),
                              [&](const PointView& view) {
                                return view.camera == drive.cameras[camera].name &&
                                       std::abs(view.time - time) < 0.5;
                              }))
          << camera << " " << time.ToSeconds();
    }
}

TEST(FindPointViews, ViewsOfOneCameraAreHalfASecondApart) {
  const std::vector<PointView> views = FindPointViews(kPoint, TenSeconds(), 100);
  for (size_t i = 0; i < views.size(); ++i)
    for (size_t j = 0; j < i; ++j)
      if (views[i].camera == views[j].camera) {
        EXPECT_GE(std::abs(views[i].time - views[j].time), 0.5 - 1e-9);
      }
  EXPECT_EQ(FindPointViews(kPoint, TenSeconds(), 3).size(), 3u);
}

TEST(FindPointViews, DistanceAndAngleAreOfTheLineOfSight) {
  const DriveViews drive = TenSeconds();
  const PointView view = FindPointViews(kPoint, drive, 1).at(0);
  const size_t camera = view.camera == "cam0" ? 0 : 1;
  const double shift = drive.rig.cameras[camera].time_shift - 0.001;
  const Eigen::Vector3d eye =
      (*drive.site_from_imu.At(view.time + shift) * drive.rig.ImuFromCamera(camera)).translation;

  EXPECT_NEAR(view.distance, (eye - kPoint).norm(), 1e-6);
  EXPECT_NEAR(std::cos(view.view_angle), eye.z() / view.distance, 1e-6);
}

TEST(FindPointViews, AMaskHidesThePoint) {
  DriveViews drive = TenSeconds();
  drive.cameras[1].mask = cv::Mat::zeros(kHeight, kWidth, CV_8UC1);

  for (const PointView& view : FindPointViews(kPoint, drive, 100)) EXPECT_EQ(view.camera, "cam0");
}

/// A floor of cells at one height around the drive.
void AddFloor(double height, DriveViews& drive) {
  drive.surface.cell_size = 0.5;
  for (int y = -20; y < 20; ++y)
    for (int x = -20; x < 120; ++x) {
      SurfaceCell cell;
      cell.x = x;
      cell.y = y;
      cell.height = static_cast<float>(height);
      drive.surface.cells.push_back(cell);
    }
}

TEST(FindPointViews, ItsOwnFloorDoesNotHideIt) {
  DriveViews drive = TenSeconds();
  const size_t without_floor = FindPointViews(kPoint, drive, 100).size();
  AddFloor(0.02, drive);

  EXPECT_EQ(FindPointViews(kPoint, drive, 100).size(), without_floor);
}

TEST(FindPointViews, ADeckAboveHidesIt) {
  DriveViews drive = TenSeconds();
  AddFloor(0.02, drive);
  Eigen::Vector3d below = kPoint;
  below.z() = -3;

  EXPECT_TRUE(FindPointViews(below, drive, 100).empty());
  drive.surface.cells.clear();
  EXPECT_FALSE(FindPointViews(below, drive, 100).empty());
}

TEST(FindPointViews, APointFarAwayIsNotShown) {
  EXPECT_TRUE(FindPointViews({200, 0, 0}, TenSeconds(), 100).empty());
  EXPECT_TRUE(FindPointViews(kPoint, {}, 100).empty());
}

}  // namespace
}  // namespace parkade
