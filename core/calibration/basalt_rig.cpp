#include "core/calibration/basalt_rig.h"

#include <algorithm>

#include "core/error.h"

namespace parkade {
namespace {

std::vector<double> NumbersOf(const YamlNode& node, std::initializer_list<const char*> keys) {
  std::vector<double> numbers;
  for (const char* key : keys) numbers.push_back(node.At(key).Number());
  return numbers;
}

void SetLens(YAML::Node& camera, const char* model, const std::vector<double>& intrinsics,
             const char* distortion = "none", const std::vector<double>& coefficients = {}) {
  camera["camera_model"] = model;
  camera["intrinsics"] = intrinsics;
  camera["distortion_model"] = distortion;
  if (!coefficients.empty()) camera["distortion_coeffs"] = coefficients;
}

void SetLens(YAML::Node& camera, const YamlNode& basalt) {
  const std::string type = basalt.At("camera_type").Text();
  const YamlNode lens = basalt.At("intrinsics");
  const std::vector<double> pinhole = NumbersOf(lens, {"fx", "fy", "cx", "cy"});
  if (type == "ds")
    return SetLens(camera, "ds", NumbersOf(lens, {"xi", "alpha", "fx", "fy", "cx", "cy"}));
  if (type == "eucm")
    return SetLens(camera, "eucm", NumbersOf(lens, {"alpha", "beta", "fx", "fy", "cx", "cy"}));
  if (type == "ucm") {
    std::vector<double> intrinsics = NumbersOf(lens, {"alpha", "fx", "fy", "cx", "cy"});
    intrinsics.insert(intrinsics.begin() + 1, 1.0);  // beta
    return SetLens(camera, "eucm", intrinsics);
  }
  if (type == "kb4")
    return SetLens(camera, "pinhole", pinhole, "equidistant",
                   NumbersOf(lens, {"k1", "k2", "k3", "k4"}));
  if (type == "pinhole") return SetLens(camera, "pinhole", pinhole);
  Require(type == "pinhole-radtan8", ErrorCode::kInvalidInput,
          basalt.where() + ".camera_type '" + type.substr(0, 40) +
              "' is not one of ds, eucm, ucm, kb4, pinhole, pinhole-radtan8");
  SetLens(camera, "pinhole", pinhole, "radtan",
          NumbersOf(lens, {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"}));
}

/// A density of noise: of three axes, the largest.
double NoiseAt(const YamlNode& root, const char* key) {
  const YamlNode node = root.At(key);
  if (!node.IsList()) return node.Number();
  const std::vector<double> axes = node.Numbers();
  return axes.empty() ? 0 : *std::max_element(axes.begin(), axes.end());
}

std::vector<double> MatrixOf(const YamlNode& motion) {
  const std::vector<double> p = NumbersOf(motion, {"px", "py", "pz"});
  const std::vector<double> q = NumbersOf(motion, {"qx", "qy", "qz", "qw"});
  const Rigid3 rigid{Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized(),
                     Eigen::Vector3d(p[0], p[1], p[2])};
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix = rigid.Matrix();
  return {matrix.data(), matrix.data() + matrix.size()};
}

}  // namespace

KalibrNodes FromBasalt(const YamlNode& file) {
  const YamlNode root = file.Has("value0") ? file.At("value0") : file;
  const std::vector<YamlNode> lenses = root.At("intrinsics").Items();
  const std::vector<YamlNode> mounts = root.At("T_imu_cam").Items();
  const std::vector<YamlNode> sizes = root.At("resolution").Items();
  Require(lenses.size() == mounts.size() && lenses.size() == sizes.size(), ErrorCode::kInvalidInput,
          root.where() + " has " + std::to_string(lenses.size()) + " intrinsics, " +
              std::to_string(mounts.size()) + " T_imu_cam and " + std::to_string(sizes.size()) +
              " resolutions: one of each per camera is needed");
  const double shift =
      root.Has("cam_time_offset_ns") ? 1e-9 * root.At("cam_time_offset_ns").Number() : 0;
  YAML::Node chain, imu;
  for (std::size_t i = 0; i < lenses.size(); ++i) {
    YAML::Node camera;
    SetLens(camera, lenses[i]);
    camera["resolution"] = sizes[i].Numbers();
    camera["T_imu_cam"] = MatrixOf(mounts[i]);
    camera["timeshift_cam_imu"] = shift;
    chain["cam" + std::to_string(i)] = camera;
  }
  imu["update_rate"] = root.At("imu_update_rate").Number();
  imu["accelerometer_noise_density"] = NoiseAt(root, "accel_noise_std");
  imu["gyroscope_noise_density"] = NoiseAt(root, "gyro_noise_std");
  imu["accelerometer_random_walk"] = NoiseAt(root, "accel_bias_std");
  imu["gyroscope_random_walk"] = NoiseAt(root, "gyro_bias_std");
  return {YamlNode(chain, file.where()), YamlNode(imu, file.where())};
}

}  // namespace parkade
