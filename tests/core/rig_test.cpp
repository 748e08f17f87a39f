#include "core/rig.h"

#include <gtest/gtest.h>

#include <fstream>
#include <opencv2/core.hpp>

#include "core/calibration/rig_files.h"
#include "core/error.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCamera = R"(cam0:
  camera_model: pinhole
  intrinsics: [458.654, 457.296, 367.215, 248.375]
  distortion_model: radtan
  distortion_coeffs: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]
  resolution: [752, 480]
  rostopic: /cam0/image_raw
  timeshift_cam_imu: -0.0075
  T_cam_imu:
  - [0.0, -1.0, 0.0, 0.1]
  - [0.0, 0.0, -1.0, 0.2]
  - [1.0, 0.0, 0.0, 0.3]
  - [0.0, 0.0, 0.0, 1.0]
)";
constexpr const char* kImu = R"(rostopic: /imu0
update_rate: 200.0
accelerometer_noise_density: 2.0e-3
accelerometer_random_walk: 3.0e-3
gyroscope_noise_density: 1.6968e-04
gyroscope_random_walk: 1.9393e-05
)";

class RigFolder : public testing::Test {
 protected:
  RigFolder() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    Write("camchain-imucam.yaml", kCamera);
    Write("imu0.yaml", kImu);
  }
  ~RigFolder() override { fs::remove_all(folder_); }

  void Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }

  /// The camera file with one piece of text replaced.
  void WriteCameraWith(const std::string& old_text, const std::string& new_text) const {
    std::string text = kCamera;
    const size_t at = text.find(old_text);
    ASSERT_NE(at, std::string::npos) << old_text;
    Write("camchain-imucam.yaml", text.replace(at, old_text.size(), new_text));
  }

  std::string ReadError() const {
    try {
      ReadRig(folder_);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kInvalidInput);
      return error.what();
    }
    return "accepted";
  }

  const fs::path folder_ = fs::path(testing::TempDir()) / ("rig_" + std::to_string(::getpid()));
};

void ExpectSameMotion(const Rigid3& a, const Rigid3& b, double tolerance = 1e-9) {
  EXPECT_LT((a.Matrix() - b.Matrix()).norm(), tolerance);
}

TEST_F(RigFolder, KalibrsFilesAreRead) {
  const Rig rig = ReadRig(folder_);

  ASSERT_EQ(rig.cameras.size(), 1U);
  const RigCamera& camera = rig.cameras[0];
  EXPECT_EQ(camera.name, "cam0");
  EXPECT_EQ(camera.topic, "/cam0/image_raw");
  EXPECT_EQ(camera.time_shift, -0.0075);
  EXPECT_EQ(camera.model.width(), 752);
  const auto& lens = std::get<RadTanProjection>(camera.model.projection());
  EXPECT_EQ(lens.fx, 458.654);
  EXPECT_EQ(lens.distortion.p2, 1.76187114e-05);
  EXPECT_EQ(rig.imu.update_rate, 200);
  EXPECT_EQ(rig.imu.gyroscope_noise_density, 1.6968e-04);
  EXPECT_FALSE(rig.vehicle.has_value());
  // T_cam_imu takes IMU coordinates to camera coordinates; without a vehicle the body is the IMU.
  const Eigen::Vector3d point_in_imu(2, 3, 4);
  const Eigen::Vector3d point_in_camera(-3 + 0.1, -4 + 0.2, 2 + 0.3);
  EXPECT_LT((camera.body_from_camera * point_in_camera - point_in_imu).norm(), 1e-12);
}

TEST_F(RigFolder, WhoNeedsCamerasAloneReadsARigWithoutAnImusFile) {
  const Rig whole = ReadRig(folder_);
  fs::remove(folder_ / "imu0.yaml");

  const Rig cameras = ReadCameraRig(folder_);

  ASSERT_EQ(cameras.cameras.size(), whole.cameras.size());
  ExpectSameMotion(cameras.cameras[0].body_from_camera, whole.cameras[0].body_from_camera);
  EXPECT_NE(ReadError().find("imu0.yaml"), std::string::npos) << "a drive needs it";
  Write("imu0.yaml", "update_rate: 200.0");
  EXPECT_THROW(ReadCameraRig(folder_), Error) << "a file that is there has to be whole";
}

TEST_F(RigFolder, TheVehicleFileMovesTheBodyAwayFromTheImu) {
  Write("vehicle.yaml",
        "T_imu_body: [[1,0,0,-1.2],[0,1,0,0],[0,0,1,-0.5],[0,0,0,1]]\nwheelbase: 2.7\ntrack: 1.55\n"
        "wheel_topic: /odom\ngnss_topic: /fix\np_body_gnss: [1.0, 0.0, 1.5]\n");

  const Rig rig = ReadRig(folder_);

  ASSERT_TRUE(rig.vehicle.has_value());
  EXPECT_EQ(rig.vehicle->wheelbase, 2.7);
  EXPECT_EQ(rig.vehicle->wheel_topic, "/odom");
  EXPECT_EQ(rig.vehicle->antenna_in_body.value(), Eigen::Vector3d(1, 0, 1.5));
  EXPECT_LT((rig.body_from_imu.translation - Eigen::Vector3d(1.2, 0, 0.5)).norm(), 1e-12);
  // The way from camera to IMU does not depend on the body.
  EXPECT_LT(
      (rig.ImuFromCamera(0) * Eigen::Vector3d(-2.9, -3.8, 2.3) - Eigen::Vector3d(2, 3, 4)).norm(),
      1e-12);
}

TEST_F(RigFolder, AFieldMapSaysWhereSignalsStand) {
  const std::string mount = "T_imu_body: [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]\ntrack: 1.5\n";
  Write("vehicle.yaml", mount +
                            "fields:\n  wheels:\n    topic: /can\n    ticks_left: data[0]\n"
                            "    ticks_right: {path: 'data[1]', scale: -1, offset: 2}\n"
                            "    stamp: {topic: /clock, path: t}\n    meters_per_tick: 0.02\n");
  const fs::path copy = folder_ / "copy";
  fs::create_directories(copy);

  WriteRig(ReadRig(folder_), copy);
  const FieldMap map = ReadRig(copy).vehicle->fields;

  EXPECT_TRUE(map.imu.empty());
  ASSERT_EQ(map.wheels.size(), 3U);
  EXPECT_EQ(map.wheels.at("ticks_left").topic, "/can");
  EXPECT_EQ(map.wheels.at("ticks_left").path, "data[0]");
  EXPECT_EQ(map.wheels.at("ticks_left").scale, 1);
  EXPECT_EQ(map.wheels.at("ticks_right").scale, -1);
  EXPECT_EQ(map.wheels.at("ticks_right").offset, 2);
  EXPECT_EQ(map.wheels.at("stamp").topic, "/clock");
  EXPECT_EQ(map.meters_per_tick, 0.02);
  Write("vehicle.yaml", mount + "fields: {wheels: {topic: /can, speed: v}}\n");
  EXPECT_EQ(ReadError(),
            "vehicle.yaml: fields.wheels needs speed and yaw_rate; or speed and steering_angle; or "
            "speed_left and speed_right; or ticks_left and ticks_right");
  Write("vehicle.yaml", mount + "fields: {gnss: {latitude: lat, longitude: lon}}\n");
  EXPECT_EQ(ReadError(), "vehicle.yaml: fields.gnss.latitude has no 'topic'");
  Write("vehicle.yaml", mount + "fields: {gnss: {topic: /gps, lat: lat}}\n");
  EXPECT_EQ(ReadError(),
            "vehicle.yaml: fields.gnss has an unknown key 'lat': known are latitude, longitude, "
            "altitude, sigma_horizontal, sigma_vertical, stamp and topic");
}

TEST_F(RigFolder, OpenVinssDialectIsTheSameRig) {
  const Rig kalibr = ReadRig(folder_);
  std::string text = kCamera;
  text.replace(text.find("T_cam_imu"), std::string::npos,
               "T_imu_cam:\n  - [0, 0, 1, -0.3]\n  - [-1, 0, 0, 0.1]\n  - [0, -1, 0, 0.2]\n  - [0, "
               "0, 0, 1]\n");
  Write("camchain-imucam.yaml", "%YAML:1.0 # need to specify the file type at the top!\n\n" + text);
  Write("imu0.yaml",
        "%YAML:1.0\nimu0:\n  rostopic: /imu0\n  accelerometer_noise_density: 2.0e-3\n"
        "  accelerometer_random_walk: 3.0e-3\n  gyroscope_noise_density: 1.6968e-04\n"
        "  gyroscope_random_walk: 1.9393e-05\n  update_rate: 200.0\n");

  const Rig openvins = ReadRig(folder_);

  ExpectSameMotion(openvins.cameras[0].body_from_camera, kalibr.cameras[0].body_from_camera);
  EXPECT_EQ(openvins.imu.accelerometer_random_walk, 3e-3);
}

TEST_F(RigFolder, ACameraWithoutItsOwnMountingIsChainedToThePreviousOne) {
  std::string second = kCamera;
  second.replace(0, 4, "cam1").replace(second.find("/cam0"), 5, "/cam1");
  second.replace(second.find("T_cam_imu"), std::string::npos,
                 "T_cn_cnm1: [[1,0,0,-0.11],[0,1,0,0],[0,0,1,0],[0,0,0,1]]\n");
  Write("camchain-imucam.yaml", second + kCamera);  // the order of the file does not matter

  const Rig rig = ReadRig(folder_);

  ASSERT_EQ(rig.cameras.size(), 2U);
  EXPECT_EQ(rig.cameras[0].name, "cam0");
  const Eigen::Vector3d in_second(-0.11, 0, 0);  // the origin of cam0 seen from cam1
  EXPECT_LT(
      (rig.cameras[1].body_from_camera * in_second - rig.cameras[0].body_from_camera.translation)
          .norm(),
      1e-12);
}

TEST_F(RigFolder, TheSignOfTheToolboxsPolynomialDoesNotMatter) {
  const std::string tail = "\n  centre: [640.5, 480.25]\n  affine: [0.9998, 4.9e-4, 2.4e-4]\n";
  const auto write = [&](const std::string& intrinsics) {
    std::string text = kCamera;
    text.replace(text.find("pinhole"), 7, "ocam").replace(text.find("radtan"), 6, "none");
    const size_t begin = text.find("intrinsics");
    text.replace(begin, text.find('\n', begin) - begin, "intrinsics: " + intrinsics + tail);
    Write("camchain-imucam.yaml", text);
  };
  write("[329, -1.6e-3, 1.1e-6, -1.9e-9]");
  const Rig forwards = ReadRig(folder_);
  write("[-329, 0.0, 1.6e-3, -1.1e-6, 1.9e-9]");
  const Rig backwards = ReadRig(folder_);

  const Eigen::Vector3d point(0.5, 0.2, 1);
  const Eigen::Vector2d pixel = forwards.cameras[0].model.Project(point).value();
  EXPECT_GT(pixel.x(), 641);
  EXPECT_GT(pixel.y(), 481);
  EXPECT_LT((backwards.cameras[0].model.Project(point).value() - pixel).norm(), 1e-12);
}

Rig RigOfEveryLens() {
  const CameraModel::Projection lenses[] = {
      PinholeProjection{700, 702, 320, 240},
      RadTanProjection{458, 457, 320, 240, {-0.28, 0.074, 2e-4, 2e-5, 1e-3}},
      KannalaBrandtProjection{320, 321, 320, 240, -0.013, 0.021, -0.012, 0.0021},
      MeiProjection{1.7, 850, 851, 320, 240, {-0.1, 0.2, 3e-4, -2e-4}},
      EucmProjection{0.63, 1.04, 320, 321, 320, 240},
      DoubleSphereProjection{-0.18, 0.59, 320, 321, 320, 240},
      OcamProjection{329, -1.6e-3, 1.1e-6, -1.9e-9, 320, 240, 0.9998, 4.9e-4, 2.4e-4}};
  Rig rig;
  rig.imu.topic = "/imu: with #odd 'characters'";
  rig.body_from_imu = {Eigen::Quaterniond(0.9, 0.1, -0.2, 0.3).normalized(), {0.1, 0.2, 0.3}};
  rig.vehicle =
      VehicleCalibration{2.7, 1.5, "/odom", "/fix", 0.001, Eigen::Vector3d(1.0 / 3, 0, 1.5)};
  rig.imu.accelerometer_scale = 9.80665;
  rig.imu.gyroscope_scale = M_PI / 180;
  for (const CameraModel::Projection& lens : lenses) {
    const double i = static_cast<double>(rig.cameras.size());
    RigCamera camera;
    camera.name = "cam" + std::to_string(rig.cameras.size());
    camera.topic = "/" + camera.name + "/image_raw";
    camera.model = CameraModel(lens, 640, 480);
    camera.body_from_camera = {Eigen::Quaterniond(0.5, 0.5, -0.5, 0.1 * i).normalized(),
                               {1.0 / 7, i, 0.9}};
    camera.time_shift = 0.001 * i / 3;
    camera.line_delay = 1e-5 * i;
    rig.cameras.push_back(camera);
  }
  rig.cameras[2].mask = cv::Mat(480, 640, CV_8UC1, cv::Scalar(255));
  rig.cameras[2].mask.rowRange(400, 480) = 0;
  return rig;
}

TEST_F(RigFolder, AWrittenRigIsReadBackTheSame) {
  const Rig rig = RigOfEveryLens();
  ValidateRig(rig);

  WriteRig(rig, folder_);
  const Rig again = ReadRig(folder_);

  ASSERT_EQ(again.cameras.size(), rig.cameras.size());
  for (size_t i = 0; i < rig.cameras.size(); ++i) {
    const RigCamera &before = rig.cameras[i], &after = again.cameras[i];
    EXPECT_EQ(after.name, before.name);
    EXPECT_EQ(after.topic, before.topic);
    EXPECT_EQ(after.time_shift, before.time_shift);
    EXPECT_EQ(after.line_delay, before.line_delay);
    ExpectSameMotion(after.body_from_camera, before.body_from_camera);
    EXPECT_EQ(after.model.projection().index(), before.model.projection().index());
    for (const Eigen::Vector3d& point :
         {Eigen::Vector3d(0.1, 0.2, 1), Eigen::Vector3d(-0.4, 0.3, 1)})
      EXPECT_EQ(after.model.Project(point).value(), before.model.Project(point).value())
          << before.name;
  }
  EXPECT_EQ(cv::norm(again.cameras[2].mask, rig.cameras[2].mask), 0);
  EXPECT_TRUE(again.cameras[1].mask.empty());
  ExpectSameMotion(again.body_from_imu, rig.body_from_imu);
  EXPECT_EQ(again.imu.topic, rig.imu.topic);
  EXPECT_EQ(again.imu.accelerometer_scale, rig.imu.accelerometer_scale);
  EXPECT_EQ(again.imu.gyroscope_scale, rig.imu.gyroscope_scale);
  EXPECT_EQ(again.vehicle->wheel_scale, rig.vehicle->wheel_scale);
  EXPECT_EQ(again.vehicle->antenna_in_body.value(), rig.vehicle->antenna_in_body.value());
}

TEST_F(RigFolder, ErrorsNameFileAndKey) {
  const auto expect_error = [&](const std::string& old_text, const std::string& new_text,
                                const std::string& wanted) {
    WriteCameraWith(old_text, new_text);
    EXPECT_NE(ReadError().find(wanted), std::string::npos)
        << ReadError() << " does not say " << wanted;
  };
  expect_error("camera_model: pinhole", "", "camchain-imucam.yaml: cam0 has no 'camera_model'");
  expect_error("pinhole", "fisheye3", "cam0.camera_model");
  expect_error("radtan", "fov", "distortion_model 'fov'");
  expect_error("[458.654, 457.296, 367.215, 248.375]", "[458.654]",
               "cam0.intrinsics must hold 4 numbers, not 1");
  expect_error("458.654", "wide", "cam0.intrinsics must be a number");
  expect_error("458.654", "-458.654", "cam0: intrinsic 'fx'");
  expect_error("458.654", ".nan", "cam0.intrinsics is not finite");
  expect_error("[752, 480]", "[752.5, 480]", "cam0.resolution");
  expect_error("  T_cam_imu:", "  T_other:", "cam0 has no 'T_cam_imu'");
  expect_error("[1.0, 0.0, 0.0, 0.3]", "[2.0, 0.0, 0.0, 0.3]",
               "cam0.T_cam_imu: a 4x4 transform is not a rigid");
  expect_error("  - [0.0, 0.0, 0.0, 1.0]\n", "", "cam0.T_cam_imu must be a 4x4 matrix");
  // A matrix that is its own data.
  expect_error("  T_cam_imu:", "  T_cam_imu: &a {data: *a}\n  other:",
               "cam0.T_cam_imu must be a list of numbers");
  expect_error("cam0:", "front:", "has no 'cam0'");
  expect_error("  rostopic", "  mask: ../secret.png\n  rostopic", "cam0.mask must lie inside");
  expect_error("  rostopic", "  mask: none.png\n  rostopic",
               "cam0.mask: 'none.png' is not a readable image");
  expect_error("cam0:", "cam0: [", "camchain-imucam.yaml is not YAML: line");
}

TEST_F(RigFolder, ErrorsNameTheImusAndTheVehiclesKeysToo) {
  Write("vehicle.yaml", "wheelbase: 2.7\n");
  EXPECT_NE(ReadError().find("vehicle.yaml has no 'T_imu_body'"), std::string::npos) << ReadError();
  Write("imu0.yaml", "rostopic: /imu0\n");
  EXPECT_NE(ReadError().find("imu0.yaml has no 'accelerometer_noise_density'"), std::string::npos)
      << ReadError();
  fs::remove(folder_ / "imu0.yaml");
  EXPECT_NE(ReadError().find("has no imu0.yaml"), std::string::npos) << ReadError();
  EXPECT_THROW(ReadRig(folder_ / "nowhere"), Error);
}

TEST_F(RigFolder, WhatKalibrCallsItsFilesIsFound) {
  const auto rename = [&](const char* from, const std::string& to) {
    fs::rename(folder_ / from, folder_ / to);
  };
  for (const auto& [chain, imu] :
       {std::pair("drive-camchain-imucam.yaml", "drive-imu.yaml"),
        std::pair("camchain-imucam-drive.yaml", "imu-drive.yaml"),
        std::pair("drive-camchain.yaml", "imu.yaml"), std::pair("camchain.yaml", "imu0.yaml")}) {
    rename("camchain-imucam.yaml", chain);
    rename("imu0.yaml", imu);
    EXPECT_EQ(ReadRig(folder_).cameras[0].topic, "/cam0/image_raw") << chain;
    EXPECT_EQ(ReadRig(folder_).imu.topic, "/imu0") << imu;
    rename(chain, "camchain-imucam.yaml");
    rename(imu, "imu0.yaml");
  }
}

TEST_F(RigFolder, OfSeveralFilesOfOneKindTheUsualOrTheFullerOneIsTaken) {
  Write("drive-imu.yaml", "rostopic: /other");
  Write("drive-camchain-imucam.yaml", "cam7: {}");
  EXPECT_EQ(ReadRig(folder_).imu.topic, "/imu0");
  EXPECT_EQ(ReadRig(folder_).cameras[0].name, "cam0");

  // Kalibr calibrates cameras first, and then cameras with the IMU.
  fs::rename(folder_ / "camchain-imucam.yaml", folder_ / "drive-camchain-imucam.yaml");
  Write("drive-camchain.yaml", "cam7: {}");
  EXPECT_EQ(ReadRig(folder_).cameras[0].name, "cam0");
}

TEST_F(RigFolder, SeveralFilesOfOneKindAreNamed) {
  fs::rename(folder_ / "imu0.yaml", folder_ / "monday-imu.yaml");
  Write("tuesday-imu.yaml", kImu);
  Write("._monday-imu.yaml", "what macOS puts beside a file");

  EXPECT_EQ(
      ReadError(),
      "the rig holds several files of one kind, 'monday-imu.yaml' and 'tuesday-imu.yaml': keep "
      "one of them");
}

TEST_F(RigFolder, TopicsMayBeLeftOut) {
  Write("imu0.yaml", std::string(kImu).substr(std::string(kImu).find('\n') + 1));
  std::string cameras = kCamera;
  cameras.replace(cameras.find("  rostopic: /cam0/image_raw\n"), 28, "");
  std::string second = cameras;
  Write("camchain-imucam.yaml", cameras + second.replace(0, 4, "cam1"));

  const Rig rig = ReadRig(folder_);
  WriteRig(rig, folder_);
  const Rig again = ReadRig(folder_);

  for (const Rig& read : {rig, again}) {
    EXPECT_EQ(read.imu.topic, "");
    ASSERT_EQ(read.cameras.size(), 2u);
    EXPECT_EQ(read.cameras[1].topic, "");
  }
}

TEST_F(RigFolder, TwoCamerasOfOneTopicAreRefused) {
  std::string second = kCamera;
  Write("camchain-imucam.yaml", kCamera + second.replace(0, 4, "cam1"));

  EXPECT_NE(ReadError().find("two cameras have the topic '/cam0/image_raw'"), std::string::npos)
      << ReadError();
}

TEST(ValidateRig, RefusesWhatCannotBe) {
  const auto is_refused = [](auto&& break_it) {
    Rig rig = RigOfEveryLens();
    break_it(rig);
    try {
      ValidateRig(rig);
    } catch (const Error&) {
      return true;
    }
    return false;
  };
  EXPECT_FALSE(is_refused([](Rig&) {}));
  EXPECT_TRUE(is_refused([](Rig& rig) { rig.cameras.clear(); }));
  EXPECT_TRUE(is_refused([](Rig& rig) { rig.cameras[1].name = "cam0"; }));
  EXPECT_TRUE(is_refused([](Rig& rig) { rig.cameras[0].model = {}; }));
  EXPECT_TRUE(is_refused([](Rig& rig) { rig.cameras[0].body_from_camera.translation.x() = NAN; }));
  EXPECT_TRUE(is_refused([](Rig& rig) { rig.cameras[0].body_from_camera.translation *= 1000; }));
  EXPECT_TRUE(is_refused([](Rig& rig) { rig.body_from_imu.translation.x() = -1270; }));
  EXPECT_TRUE(is_refused([](Rig& rig) { rig.cameras[0].line_delay = 1; }));
  EXPECT_TRUE(is_refused([](Rig& rig) { rig.cameras[2].mask = cv::Mat(10, 10, CV_8UC1); }));
  EXPECT_TRUE(is_refused([](Rig& rig) { rig.imu.gyroscope_noise_density = 0; }));
  EXPECT_TRUE(is_refused([](Rig& rig) { rig.vehicle->wheelbase = -1; }));
}

TEST(ReadRig, TheRealRigOfTheKittiClipLooksForward) {
  const char* root = std::getenv("PARKADE_SHARED_DATA");
  const fs::path folder = fs::path(root != nullptr ? root : "../shared/data") / "kitti_06_clip/rig";
  if (!fs::exists(folder)) GTEST_SKIP() << "no shared data: set PARKADE_SHARED_DATA";

  const Rig rig = ReadRig(folder);

  ASSERT_EQ(rig.cameras.size(), 2U);
  // Optical axis along the IMU's x, 0.54 m baseline.
  EXPECT_GT((rig.ImuFromCamera(0).rotation * Eigen::Vector3d::UnitZ()).x(), 0.999);
  EXPECT_NEAR((rig.ImuFromCamera(0).translation - rig.ImuFromCamera(1).translation).norm(), 0.537,
              0.001);
}

}  // namespace
}  // namespace parkade
