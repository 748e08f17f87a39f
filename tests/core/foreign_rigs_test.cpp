// Calibrations as other tools than Kalibr write them.

#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"
#include "core/rig.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

class ForeignRig : public testing::Test {
 protected:
  ForeignRig() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~ForeignRig() override { fs::remove_all(folder_); }

  void Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }

  std::string ReadError() const {
    try {
      ReadRig(folder_);
    } catch (const Error& error) {
      return error.what();
    }
    return "accepted";
  }

  const fs::path folder_ =
      fs::path(testing::TempDir()) / ("foreign_rig_" + std::to_string(::getpid()));
};

constexpr const char* kNoise =
    "accelerometer_noise_density: 2.0e-3\naccelerometer_random_walk: 3.0e-3\n"
    "gyroscope_noise_density: 1.7e-04\ngyroscope_random_walk: 1.9e-05\n";
constexpr const char* kMount = "  T_cam_imu: [[1,0,0,0.1],[0,1,0,0],[0,0,1,0],[0,0,0,1]]\n";

/// As the toolbox writes it: rows before columns, z backwards.
std::string OcamText(const std::string& polynomial) {
  return "#polynomial coefficients for the DIRECT mapping function\n\n" + polynomial +
         " \n\n#polynomial coefficients for the inverse mapping function\n\n3 180.0 120.0 4.0 \n\n"
         "#center: \"row\" and \"column\", starting from 0 (C convention)\n\n241.5 318.25\n\n"
         "#affine parameters \"c\", \"d\", \"e\"\n\n1.002 0.0004 -0.0003\n\n"
         "#image size: \"height\" and \"width\"\n\n480 640\n\n";
}

constexpr const char* kPolynomial = "5 -160.0 0.0 1.9e-03 -1.5e-06 9.0e-09";

TEST_F(ForeignRig, ALensOfOCamCalibSeesAsTheToolboxSays) {
  Write("imu0.yaml", kNoise);
  Write("front.txt", OcamText(kPolynomial));
  Write("camchain-imucam.yaml",
        std::string("cam0:\n  camera_model: ocam\n  ocam_file: front.txt\n") + kMount);

  const CameraModel model = ReadRig(folder_).cameras.at(0).model;

  EXPECT_EQ(model.width(), 640);
  EXPECT_EQ(model.height(), 480);
  for (const auto& [row, column] : {std::pair(241.5, 318.25), {100.0, 500.0}, {400.0, 90.0}}) {
    // Its cam2world.m: the point of the sensor by the inverse of [c d; e 1].
    const Eigen::Matrix2d affine = (Eigen::Matrix2d() << 1.002, 0.0004, -0.0003, 1).finished();
    const Eigen::Vector2d m = affine.inverse() * Eigen::Vector2d(row - 241.5, column - 318.25);
    const double r = m.norm();
    const double z = -160 + 1.9e-3 * r * r - 1.5e-6 * r * r * r + 9e-9 * r * r * r * r;
    const Eigen::Vector3d expected = Eigen::Vector3d(m.y(), m.x(), -z).normalized();

    const auto bearing = model.Unproject({column, row});
    ASSERT_TRUE(bearing.has_value());
    EXPECT_LT((bearing->normalized() - expected).norm(), 1e-9) << row << ' ' << column;
  }
}

TEST_F(ForeignRig, APolynomialThatTheLensCannotHoldIsRefused) {
  Write("imu0.yaml", kNoise);
  Write("camchain-imucam.yaml",
        std::string("cam0:\n  camera_model: ocam\n  ocam_file: front.txt\n") + kMount);

  EXPECT_EQ(ReadError(), "camchain-imucam.yaml: cam0.ocam_file: the rig has no file 'front.txt'");
  Write("front.txt", OcamText("6 -160.0 0.0 1.9e-03 -1.5e-06 9.0e-09 1e-12"));
  EXPECT_EQ(ReadError(),
            "'front.txt' has a polynomial of degree 5, of which Parkade knows 4 at most: calibrate "
            "with the degree 4");
  Write("front.txt", OcamText("3 -160.0 0.1 1.9e-03"));
  EXPECT_EQ(ReadError(),
            "'front.txt' has a polynomial with a linear part, which Parkade's lens cannot hold");
  Write("front.txt", "1 2 3");
  EXPECT_EQ(ReadError(), "'front.txt' is no calib_results.txt of OCamCalib");
}

TEST_F(ForeignRig, NothingOfOpenCvsLongModelsIsCutOff) {
  Write("imu0.yaml", kNoise);
  const auto write = [&](const std::string& coefficients) {
    Write("camchain-imucam.yaml",
          "cam0:\n  camera_model: pinhole\n  intrinsics: [400, 400, 320, 240]\n"
          "  distortion_model: radtan\n  resolution: [640, 480]\n  distortion_coeffs: [-0.1, 0.01, "
          "0, 0, 0.001" +
              coefficients + "]\n" + kMount);
  };

  write(", 0, 0, 0");
  EXPECT_EQ(
      std::get<RadTanProjection>(ReadRig(folder_).cameras.at(0).model.projection()).distortion.k3,
      0.001);
  write(", 0.2, 0, 0");
  EXPECT_EQ(ReadError(),
            "camchain-imucam.yaml: cam0.distortion_coeffs are of OpenCV's rational model, which "
            "Parkade does not know: calibrate with radtan (4 or 5 coefficients) or equidistant");
  write(", 0, 0, 0, 0.1, 0, 0, 0");
  EXPECT_NE(ReadError().find("thin prism"), std::string::npos);
}

// As basalt_calibrate_imu writes it (cereal).
std::string BasaltText(const std::string& lens) {
  return R"({
    "value0": {
        "T_imu_cam": [
            {"px": 0.1, "py": -0.2, "pz": 0.3, "qx": 0.0, "qy": 0.0, "qz": 0.7071067811865476,
             "qw": 0.7071067811865476},
            {"px": 0, "py": 0, "pz": 0, "qx": 0, "qy": 0, "qz": 0, "qw": 1}
        ],
        "intrinsics": [
            {"camera_type": "ds", "intrinsics": {"fx": 349.7, "fy": 348.9, "cx": 365.6, "cy": 249.4,
             "xi": -0.24, "alpha": 0.57}},
            )" +
         lens + R"(
        ],
        "resolution": [[752, 480], [752, 480]],
        "calib_accel_bias": [0, 0, 0, 0, 0, 0, 0, 0, 0],
        "imu_update_rate": 200.0,
        "accel_noise_std": [0.016, 0.015, 0.016],
        "gyro_noise_std": [0.000282, 0.000282, 0.000282],
        "accel_bias_std": [0.001, 0.001, 0.001],
        "gyro_bias_std": [0.0001, 0.0001, 0.0001],
        "cam_time_offset_ns": 2000000,
        "vignette": []
    }
})";
}

TEST_F(ForeignRig, BasaltsCalibrationIsRead) {
  Write("euroc_calib.json",
        BasaltText(R"({"camera_type": "kb4", "intrinsics": {"fx": 380, "fy": 381, "cx": 360,
          "cy": 250, "k1": 0.01, "k2": 0.02, "k3": 0.03, "k4": 0.04}})"));

  const Rig rig = ReadRig(folder_);

  ASSERT_EQ(rig.cameras.size(), 2U);
  const auto& sphere = std::get<DoubleSphereProjection>(rig.cameras[0].model.projection());
  EXPECT_EQ(sphere.xi, -0.24);
  EXPECT_EQ(sphere.alpha, 0.57);
  EXPECT_EQ(sphere.cy, 249.4);
  EXPECT_EQ(std::get<KannalaBrandtProjection>(rig.cameras[1].model.projection()).k4, 0.04);
  EXPECT_EQ(rig.cameras[0].model.width(), 752);
  EXPECT_EQ(rig.cameras[0].time_shift, 0.002);
  EXPECT_EQ(rig.imu.update_rate, 200);
  EXPECT_EQ(rig.imu.accelerometer_noise_density, 0.016);
  EXPECT_EQ(rig.imu.gyroscope_random_walk, 0.0001);
  // T_imu_cam takes camera coordinates to IMU coordinates: x of the camera is y of the IMU.
  EXPECT_LT(
      (rig.ImuFromCamera(0) * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(0.1, 0.8, 0.3)).norm(),
      1e-9);
}

TEST_F(ForeignRig, WhatBasaltsLensesCannotBeIsNamed) {
  Write("calibration.json", BasaltText(R"({"camera_type": "fov", "intrinsics": {"fx": 380,
          "fy": 381, "cx": 360, "cy": 250, "w": 0.9}})"));
  EXPECT_EQ(ReadError(),
            "calibration.json: value0.intrinsics[1].camera_type 'fov' is not one of ds, eucm, ucm, "
            "kb4, pinhole, pinhole-radtan8");
  Write("calibration.json",
        BasaltText(R"({"camera_type": "pinhole-radtan8", "intrinsics": {"fx": 380, "fy": 381,
          "cx": 360, "cy": 250, "k1": 0.1, "k2": 0, "p1": 0, "p2": 0, "k3": 0, "k4": 0.3, "k5": 0,
          "k6": 0, "rpmax": 2.7}})"));
  EXPECT_NE(ReadError().find("rational model"), std::string::npos) << ReadError();
  Write("calibration.json", R"({"value0": {"intrinsics": []}})");
  EXPECT_EQ(ReadError(), "calibration.json: value0 has no 'T_imu_cam'");
}

TEST_F(ForeignRig, OpenVinssFilesAreRead) {
  Write("kalibr_imucam_chain.yaml",
        "%YAML:1.0\n\ncam0:\n  T_imu_cam: #rotation from camera to IMU R_CtoI, position of camera "
        "in IMU p_CinI\n    - [0.0, -1.0, 0.0, 0.1]\n    - [1.0, 0.0, 0.0, 0.2]\n"
        "    - [0.0, 0.0, 1.0, 0.3]\n    - [0.0, 0.0, 0.0, 1.0]\n"
        "  cam_overlaps: [1]\n  camera_model: pinhole\n"
        "  distortion_coeffs: [-0.28, 0.07, 0.0002, 1.8e-05]\n  distortion_model: radtan\n"
        "  intrinsics: [458.7, 457.3, 367.2, 248.4] #fu, fv, cu, cv\n  resolution: [752, 480]\n"
        "  rostopic: /cam0/image_raw\n  timeshift_cam_imu: 0.01\n");
  Write("kalibr_imu_chain.yaml",
        std::string("%YAML:1.0\n\nimu0:\n  T_i_b:\n    - [1.0, 0.0, 0.0, 0.0]\n    - [0.0, 1.0, "
                    "0.0, 0.0]\n    - [0.0, 0.0, 1.0, 0.0]\n    - [0.0, 0.0, 0.0, 1.0]\n") +
            "  accelerometer_noise_density: 2.0e-3\n  accelerometer_random_walk: 3.0e-3\n"
            "  gyroscope_noise_density: 1.7e-04\n  gyroscope_random_walk: 1.9e-05\n"
            "  rostopic: /imu0\n  time_offset: 0.0\n  update_rate: 200.0\n  model: \"kalibr\"\n"
            "  Tw:\n    - [1.0, 0.0, 0.0]\n    - [0.0, 1.0, 0.0]\n    - [0.0, 0.0, 1.0]\n");

  const Rig rig = ReadRig(folder_);

  ASSERT_EQ(rig.cameras.size(), 1U);
  EXPECT_EQ(rig.imu.topic, "/imu0");
  EXPECT_EQ(rig.imu.update_rate, 200);
  EXPECT_EQ(rig.cameras[0].time_shift, 0.01);
  EXPECT_LT(
      (rig.ImuFromCamera(0) * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(0.1, 1.2, 0.3)).norm(),
      1e-12);
}

}  // namespace
}  // namespace parkade
