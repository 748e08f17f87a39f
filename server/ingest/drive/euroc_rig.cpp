#include "server/ingest/drive/euroc_rig.h"

#include <yaml-cpp/yaml.h>

#include "core/error.h"
#include "core/files/file.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

/// One sensor.yaml, with errors that name file and key.
class SensorFile {
 public:
  SensorFile(const fs::path& folder, const std::string& sensor) : name_(sensor + "/sensor.yaml") {
    Require(fs::is_regular_file(folder / name_), ErrorCode::kInvalidInput,
            "no rig: " + name_ + " is missing");
    std::string text = ReadFile(folder / name_, std::size_t{1} << 20);
    // OpenCV's "%YAML:1.0" is no YAML directive.
    if (text.starts_with("%YAML:")) text.erase(0, text.find('\n'));
    try {
      root_ = YAML::Load(text);
    } catch (const YAML::Exception& error) {
      Fail("is not YAML: " + error.msg);
    }
    if (!root_.IsMap()) Fail("is not a YAML mapping");
  }

  std::vector<double> Numbers(const std::string& key, std::size_t min_count) const {
    return NumbersOf(root_[key], key, min_count);
  }

  double NumberOr(const std::string& key, double fallback) const {
    return root_[key] ? As<double>(root_[key], key) : fallback;
  }

  std::string Text(const std::string& key) const {
    if (!root_[key]) Fail("has no '" + key + "'");
    return As<std::string>(root_[key], key);
  }

  /// T_BS as {rows, cols, data}, a flat list or a list of rows; identity where it is missing and
  /// `is_required` is not.
  Rigid3 BodyFromSensor(bool is_required) const {
    const YAML::Node node = root_["T_BS"];
    if (!node && !is_required) return {};
    const std::vector<double> values =
        NumbersOf(node && node.IsMap() ? node["data"] : node, "T_BS", 16);
    try {
      return Rigid3::FromMatrix(
          Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(values.data()));
    } catch (const Error& error) {
      Fail(std::string("has a wrong 'T_BS': ") + error.what());
    }
  }

  [[noreturn]] void Fail(const std::string& what) const {
    throw Error(ErrorCode::kInvalidInput, name_ + " " + what);
  }

 private:
  template <typename T>
  T As(const YAML::Node& node, const std::string& key) const {
    try {
      return node.as<T>();
    } catch (const YAML::Exception&) {
      Fail("has a wrong '" + key + "'");
    }
  }

  std::vector<double> NumbersOf(const YAML::Node& node, const std::string& key,
                                std::size_t min_count) const {
    if (!node) Fail("has no '" + key + "'");
    std::vector<double> numbers;
    if (node.IsSequence())
      for (const YAML::Node& element : node)
        for (const double number : element.IsSequence()
                                       ? As<std::vector<double>>(element, key)
                                       : std::vector<double>{As<double>(element, key)})
          numbers.push_back(number);
    if (numbers.size() < min_count)
      Fail("needs " + std::to_string(min_count) + " numbers in '" + key + "'");
    return numbers;
  }

  std::string name_;
  YAML::Node root_;
};

CameraModel ReadModel(const SensorFile& file) {
  constexpr double kMaxSide = 16384;
  const std::vector<double> resolution = file.Numbers("resolution", 2);
  for (const double side : resolution)
    if (!(side >= 1 && side <= kMaxSide)) file.Fail("has a wrong 'resolution'");
  const std::vector<double> f = file.Numbers("intrinsics", 4);
  const std::string model = file.Text("camera_model");
  if (model != "pinhole")
    file.Fail("has camera_model '" + model + "': only pinhole is supported here, bring a rig");
  const std::string distortion = file.Text("distortion_model");
  CameraModel::Projection projection;
  if (distortion == "radial-tangential" || distortion == "radtan" || distortion == "plumb_bob") {
    const std::vector<double> d = file.Numbers("distortion_coefficients", 4);
    RadTanDistortion radtan{
        .k1 = d[0], .k2 = d[1], .p1 = d[2], .p2 = d[3], .k3 = d.size() > 4 ? d[4] : 0};
    projection = RadTanProjection{f[0], f[1], f[2], f[3], radtan};
  } else if (distortion == "equidistant") {
    const std::vector<double> d = file.Numbers("distortion_coefficients", 4);
    projection = KannalaBrandtProjection{.fx = f[0],
                                         .fy = f[1],
                                         .cx = f[2],
                                         .cy = f[3],
                                         .k1 = d[0],
                                         .k2 = d[1],
                                         .k3 = d[2],
                                         .k4 = d[3]};
  } else if (distortion == "none") {
    projection = PinholeProjection{f[0], f[1], f[2], f[3]};
  } else {
    file.Fail("has distortion_model '" + distortion +
              "': known are radial-tangential, equidistant and none");
  }
  return CameraModel(projection, static_cast<int>(resolution[0]), static_cast<int>(resolution[1]));
}

ImuCalibration ReadImu(const SensorFile& file) {
  ImuCalibration imu;
  imu.topic = "imu0";
  imu.update_rate = file.NumberOr("rate_hz", imu.update_rate);
  imu.accelerometer_noise_density =
      file.NumberOr("accelerometer_noise_density", imu.accelerometer_noise_density);
  imu.accelerometer_random_walk =
      file.NumberOr("accelerometer_random_walk", imu.accelerometer_random_walk);
  imu.gyroscope_noise_density =
      file.NumberOr("gyroscope_noise_density", imu.gyroscope_noise_density);
  imu.gyroscope_random_walk = file.NumberOr("gyroscope_random_walk", imu.gyroscope_random_walk);
  return imu;
}

}  // namespace

Rig ReadEurocRig(const fs::path& folder) {
  constexpr int kMaxCameras = 1000;
  Require(fs::exists(folder / "imu0"), ErrorCode::kInvalidInput,
          "the log has no IMU data (imu0/data.csv)");
  const SensorFile imu_file(folder, "imu0");
  Rig rig;
  rig.imu = ReadImu(imu_file);
  const Rigid3 euroc_body_from_imu = imu_file.BodyFromSensor(/*is_required=*/false);
  const bool has_vehicle = fs::is_regular_file(folder / "odom0" / "data.csv");
  // Without wheels nothing ties EuRoC's body to the car: body is then the IMU frame, as core/rig.h
  // says.
  const Rigid3 body_from_euroc_body = has_vehicle ? Rigid3{} : euroc_body_from_imu.Inverse();
  rig.body_from_imu = body_from_euroc_body * euroc_body_from_imu;
  if (has_vehicle) {
    rig.vehicle.emplace();
    rig.vehicle->wheel_topic = "odom0";
    rig.vehicle->gnss_topic = "gnss0";
  }
  for (int i = 0; i < kMaxCameras; ++i) {
    const std::string name = "cam" + std::to_string(i);
    if (!fs::is_regular_file(folder / name / "data.csv")) continue;
    const SensorFile file(folder, name);
    RigCamera camera;
    camera.name = camera.topic = name;
    camera.model = ReadModel(file);
    camera.body_from_camera = body_from_euroc_body * file.BodyFromSensor(/*is_required=*/true);
    camera.time_shift = file.NumberOr("timeshift_cam_imu", 0);
    rig.cameras.push_back(std::move(camera));
  }
  Require(!rig.cameras.empty(), ErrorCode::kInvalidInput, "the log has no images (cam0/data.csv)");
  ValidateRig(rig);
  return rig;
}

}  // namespace parkade
