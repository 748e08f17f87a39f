#include <algorithm>
#include <opencv2/imgcodecs.hpp>

#include "core/calibration/basalt_rig.h"
#include "core/calibration/ocam_file.h"
#include "core/calibration/rig_fields.h"
#include "core/calibration/rig_files.h"
#include "core/calibration/yaml_file.h"
#include "core/error.h"
#include "core/files/file.h"
#include "core/rig.h"

namespace parkade {
namespace {

using std::filesystem::path;

std::vector<std::string> NamesIn(const path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.push_back(entry.path().filename());
  return names;
}

std::string TextOr(const YamlNode& node, const std::string& key, const std::string& otherwise) {
  return node.Has(key) ? node.At(key).Text() : otherwise;
}

double NumberOr(const YamlNode& node, const std::string& key, double otherwise) {
  return node.Has(key) ? node.At(key).Number() : otherwise;
}

/// The list under `key`, of one of the allowed sizes.
std::vector<double> NumbersAt(const YamlNode& node, const std::string& key,
                              std::initializer_list<size_t> sizes) {
  const YamlNode list = node.At(key);
  std::vector<double> numbers = list.Numbers();
  std::string allowed;
  for (const size_t size : sizes) allowed += (allowed.empty() ? "" : " or ") + std::to_string(size);
  Require(
      std::find(sizes.begin(), sizes.end(), numbers.size()) != sizes.end(),
      ErrorCode::kInvalidInput,
      list.where() + " must hold " + allowed + " numbers, not " + std::to_string(numbers.size()));
  return numbers;
}

/// Cuts nothing off OpenCV's longer models: beyond k3 all must be 0.
RadTanDistortion ReadRadTan(const YamlNode& camera) {
  std::vector<double> k = NumbersAt(camera, "distortion_coeffs", {4, 5, 8, 12, 14});
  for (std::size_t i = 5; i < k.size(); ++i)
    Require(k[i] == 0, ErrorCode::kInvalidInput,
            camera.where() + ".distortion_coeffs are of OpenCV's " +
                (i < 8    ? "rational model"
                 : i < 12 ? "thin prism model"
                          : "tilted sensor model") +
                ", which Parkade does not know: calibrate with radtan (4 or 5 coefficients) or "
                "equidistant");
  k.resize(5, 0.0);
  return {.k1 = k[0], .k2 = k[1], .p1 = k[2], .p2 = k[3], .k3 = k[4]};
}

CameraModel::Projection ReadPinhole(const YamlNode& camera, const std::string& distortion) {
  const std::vector<double> f = NumbersAt(camera, "intrinsics", {4});
  if (distortion == "radtan")
    return RadTanProjection{
        .fx = f[0], .fy = f[1], .cx = f[2], .cy = f[3], .distortion = ReadRadTan(camera)};
  if (distortion == "equidistant") {
    const std::vector<double> k = NumbersAt(camera, "distortion_coeffs", {4});
    return KannalaBrandtProjection{.fx = f[0],
                                   .fy = f[1],
                                   .cx = f[2],
                                   .cy = f[3],
                                   .k1 = k[0],
                                   .k2 = k[1],
                                   .k3 = k[2],
                                   .k4 = k[3]};
  }
  return PinholeProjection{.fx = f[0], .fy = f[1], .cx = f[2], .cy = f[3]};
}

OcamProjection ReadOcam(const YamlNode& camera) {
  std::vector<double> a = NumbersAt(camera, "intrinsics", {4, 5});
  if (a.size() == 5) {  // the toolbox writes its a1, which is always zero
    Require(a[1] == 0, ErrorCode::kInvalidInput,
            camera.where() + ".intrinsics: a1 of an ocam lens must be 0");
    a.erase(a.begin() + 1);
  }
  // The toolbox's z points backwards: see OcamProjection.
  if (a[0] < 0)
    for (double& coefficient : a) coefficient = -coefficient;
  const std::vector<double> center = NumbersAt(camera, "centre", {2});
  const std::vector<double> affine =
      camera.Has("affine") ? NumbersAt(camera, "affine", {3}) : std::vector<double>{1, 0, 0};
  return {.a0 = a[0],
          .a2 = a[1],
          .a3 = a[2],
          .a4 = a[3],
          .cx = center[0],
          .cy = center[1],
          .c = affine[0],
          .d = affine[1],
          .e = affine[2]};
}

CameraModel::Projection ReadProjection(const YamlNode& camera) {
  const std::string model = camera.At("camera_model").Text();
  constexpr std::string_view kModels[] = {"pinhole", "omni", "ds", "eucm", "ocam"};
  Require(
      std::find(std::begin(kModels), std::end(kModels), model) != std::end(kModels),
      ErrorCode::kInvalidInput,
      camera.where() + ".camera_model '" + model + "' is not one of pinhole, omni, ds, eucm, ocam");
  const std::string distortion = TextOr(camera, "distortion_model", "none");
  const auto allow = [&](std::initializer_list<std::string_view> distortions) {
    Require(std::find(distortions.begin(), distortions.end(), distortion) != distortions.end(),
            ErrorCode::kInvalidInput,
            camera.where() + ": camera_model '" + model + "' with distortion_model '" + distortion +
                "' is not supported");
  };
  if (model == "pinhole") {
    allow({"none", "radtan", "equidistant"});
    return ReadPinhole(camera, distortion);
  }
  if (model == "omni") {
    allow({"none", "radtan"});
    const std::vector<double> f = NumbersAt(camera, "intrinsics", {5});
    return MeiProjection{
        .xi = f[0],
        .fx = f[1],
        .fy = f[2],
        .cx = f[3],
        .cy = f[4],
        .distortion = distortion == "radtan" ? ReadRadTan(camera) : RadTanDistortion{}};
  }
  allow({"none"});
  if (model == "ocam") return ReadOcam(camera);
  const std::vector<double> f = NumbersAt(camera, "intrinsics", {6});
  if (model == "ds")
    return DoubleSphereProjection{
        .xi = f[0], .alpha = f[1], .fx = f[2], .fy = f[3], .cx = f[4], .cy = f[5]};
  return EucmProjection{
      .alpha = f[0], .beta = f[1], .fx = f[2], .fy = f[3], .cx = f[4], .cy = f[5]};
}

CameraModel ReadModel(const YamlNode& camera) {
  const YamlNode resolution = camera.At("resolution");
  const std::vector<double> size = NumbersAt(camera, "resolution", {2});
  for (const double edge : size)
    Require(edge >= 1 && edge <= 16384 && edge == std::round(edge), ErrorCode::kInvalidInput,
            resolution.where() + " must be two whole numbers in 1..16384");
  try {
    return {ReadProjection(camera), static_cast<int>(size[0]), static_cast<int>(size[1])};
  } catch (const Error& error) {
    const std::string message = error.what();
    if (message.starts_with(camera.where())) throw;
    throw Error(error.code(), camera.where() + ": " + message);
  }
}

/// The file that a key names, in the rig's folder.
path FileAt(const YamlNode& node, const path& folder) {
  const path relative = node.Text();
  const bool leaves_folder =
      relative.is_absolute() || relative.lexically_normal().string().starts_with("..");
  Require(!leaves_folder, ErrorCode::kInvalidInput,
          node.where() + " must lie inside the rig's folder");
  return folder / relative;
}

cv::Mat ReadMask(const YamlNode& camera, const path& folder) {
  if (!camera.Has("mask")) return {};
  const YamlNode node = camera.At("mask");
  const path file = FileAt(node, folder);
  cv::Mat mask;
  if (IsFile(file)) mask = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
  Require(!mask.empty(), ErrorCode::kInvalidInput,
          node.where() + ": '" + node.Text() + "' is not a readable image");
  return mask;
}

/// The camera with the lens in the file of another tool that it may name.
YamlNode WithLensFile(const YamlNode& camera, const path& folder) {
  if (!camera.Has("ocam_file")) return camera;
  const YamlNode node = camera.At("ocam_file");
  const path file = FileAt(node, folder);
  Require(std::filesystem::is_regular_file(file), ErrorCode::kInvalidInput,
          node.where() + ": the rig has no file '" + node.Text() + "'");
  return camera.With(ReadOcamFile(file));
}

/// "cam0" ... "camN" in the order of their numbers.
std::vector<std::string> CameraNames(const YamlNode& chain) {
  std::vector<std::pair<int, std::string>> numbered;
  for (const std::string& key : chain.Keys()) {
    const std::string number = key.starts_with("cam") ? key.substr(3) : "";
    if (!number.empty() && number.size() < 5 &&
        number.find_first_not_of("0123456789") == std::string::npos)
      numbered.emplace_back(std::stoi(number), key);
  }
  std::sort(numbered.begin(), numbered.end());
  std::vector<std::string> names;
  names.reserve(numbered.size());
  for (const auto& [number, name] : numbered) names.push_back(name);
  return names;
}

/// From T_cam_imu, OpenVINS's T_imu_cam, or the previous camera and T_cn_cnm1.
Rigid3 ReadCameraFromImu(const YamlNode& camera, const std::optional<Rigid3>& previous_from_imu) {
  if (camera.Has("T_cam_imu")) return camera.At("T_cam_imu").Motion();
  if (camera.Has("T_imu_cam")) return camera.At("T_imu_cam").Motion().Inverse();
  Require(camera.Has("T_cn_cnm1") && previous_from_imu.has_value(), ErrorCode::kInvalidInput,
          camera.where() + " has no 'T_cam_imu'");
  return camera.At("T_cn_cnm1").Motion() * *previous_from_imu;
}

ImuCalibration ReadImu(const YamlNode& root) {
  const YamlNode imu = root.Has("imu0") ? root.At("imu0") : root;
  return {.topic = TextOr(imu, "rostopic", ""),
          .update_rate = NumberOr(imu, "update_rate", ImuCalibration{}.update_rate),
          .accelerometer_noise_density = imu.At("accelerometer_noise_density").Number(),
          .accelerometer_random_walk = imu.At("accelerometer_random_walk").Number(),
          .gyroscope_noise_density = imu.At("gyroscope_noise_density").Number(),
          .gyroscope_random_walk = imu.At("gyroscope_random_walk").Number(),
          .accelerometer_scale = NumberOr(imu, "accelerometer_scale", 1),
          .gyroscope_scale = NumberOr(imu, "gyroscope_scale", 1)};
}

VehicleCalibration ReadVehicle(const YamlNode& vehicle) {
  VehicleCalibration calibration{.wheelbase = NumberOr(vehicle, "wheelbase", 0),
                                 .track = NumberOr(vehicle, "track", 0),
                                 .wheel_topic = TextOr(vehicle, "wheel_topic", ""),
                                 .gnss_topic = TextOr(vehicle, "gnss_topic", ""),
                                 .wheel_scale = NumberOr(vehicle, "wheel_scale", 1),
                                 .antenna_in_body = {}};
  if (vehicle.Has("fields")) calibration.fields = ReadFieldMap(vehicle.At("fields"));
  if (vehicle.Has("p_body_gnss")) {
    const std::vector<double> antenna = NumbersAt(vehicle, "p_body_gnss", {3});
    calibration.antenna_in_body = Eigen::Vector3d(antenna[0], antenna[1], antenna[2]);
  }
  return calibration;
}

/// \param imu    nothing: the rig has cameras alone
/// \param masks  the folder that masks and lens files lie in
Rig MakeRig(const std::optional<YamlNode>& imu, const std::optional<YamlNode>& vehicle,
            const YamlNode& chain, const path& masks) {
  Rig rig;
  if (imu) rig.imu = ReadImu(*imu);
  if (vehicle) {
    rig.body_from_imu = vehicle->At("T_imu_body").Motion().Inverse();
    rig.vehicle = ReadVehicle(*vehicle);
  }
  std::optional<Rigid3> previous_from_imu;
  for (const std::string& name : CameraNames(chain)) {
    const YamlNode node = WithLensFile(chain.At(name), masks);
    const Rigid3 camera_from_imu = ReadCameraFromImu(node, previous_from_imu);
    rig.cameras.push_back({.name = name,
                           .topic = TextOr(node, "rostopic", ""),
                           .model = ReadModel(node),
                           .body_from_camera = rig.body_from_imu * camera_from_imu.Inverse(),
                           .time_shift = NumberOr(node, "timeshift_cam_imu", 0),
                           .line_delay = NumberOr(node, "line_delay", 0),
                           .mask = ReadMask(node, masks)});
    previous_from_imu = camera_from_imu;
  }
  Require(!rig.cameras.empty(), ErrorCode::kInvalidInput, chain.where() + " has no 'cam0'");
  try {
    ValidateRig(rig);
  } catch (const Error& error) {
    throw Error(error.code(), "the rig '" + masks.filename().string() + "': " + error.what());
  }
  return rig;
}

Rig ReadFolder(const path& folder, bool needs_imu) {
  Require(std::filesystem::is_directory(folder), ErrorCode::kInvalidInput,
          "the rig '" + folder.string() + "' is not a folder");
  const auto [chain, imu, basalt] = FindRigFiles(NamesIn(folder));
  std::optional<YamlNode> imu_node, vehicle;
  const bool has_imu_elsewhere = chain.empty() && !basalt.empty();
  if ((needs_imu && !has_imu_elsewhere) || !imu.empty())
    imu_node = ReadYaml(folder / (imu.empty() ? kImuFile : imu));
  if (std::filesystem::exists(folder / "vehicle.yaml")) vehicle = ReadYaml(folder / "vehicle.yaml");
  if (chain.empty() && !basalt.empty()) {
    const KalibrNodes nodes = FromBasalt(ReadYaml(folder / basalt));
    return MakeRig(imu.empty() ? nodes.imu : imu_node, vehicle, nodes.chain, folder);
  }
  return MakeRig(imu_node, vehicle, ReadYaml(folder / (chain.empty() ? kCameraChainFile : chain)),
                 folder);
}

}  // namespace

Rig ReadRig(const path& folder) { return ReadFolder(folder, /*needs_imu=*/true); }

Rig ReadCameraRig(const path& folder) { return ReadFolder(folder, /*needs_imu=*/false); }

Rig ReadCalibration(const path& file) {
  const YamlNode calibration = ReadYaml(file);
  std::optional<YamlNode> vehicle;
  if (calibration.Has("vehicle")) vehicle = calibration.At("vehicle");
  return MakeRig(calibration, vehicle, calibration, file.parent_path());
}

}  // namespace parkade
