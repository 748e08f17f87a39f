#include <yaml-cpp/yaml.h>

#include <opencv2/imgcodecs.hpp>

#include "core/calibration/rig_fields.h"
#include "core/error.h"
#include "core/files/file.h"
#include "core/rig.h"

namespace parkade {
namespace {

using std::filesystem::path;

void WriteNumbers(YAML::Emitter& out, const char* key, const std::vector<double>& numbers) {
  out << YAML::Key << key << YAML::Value << YAML::Flow << numbers;
}

void WriteMotion(YAML::Emitter& out, const char* key, const Rigid3& motion) {
  const Eigen::Matrix4d matrix = motion.Matrix();
  out << YAML::Key << key << YAML::Value << YAML::BeginSeq;
  for (Eigen::Index row = 0; row < 4; ++row)
    out << YAML::Flow
        << std::vector<double>{matrix(row, 0), matrix(row, 1), matrix(row, 2), matrix(row, 3)};
  out << YAML::EndSeq;
}

/// Writes camera_model, intrinsics, distortion_model and distortion_coeffs of each lens.
struct LensWriter {
  YAML::Emitter& out;

  void Write(const char* model, const std::vector<double>& intrinsics, const char* distortion_model,
             const std::vector<double>& distortion) const {
    out << YAML::Key << "camera_model" << YAML::Value << model;
    WriteNumbers(out, "intrinsics", intrinsics);
    out << YAML::Key << "distortion_model" << YAML::Value << distortion_model;
    WriteNumbers(out, "distortion_coeffs", distortion);
  }
  static std::vector<double> Coefficients(const RadTanDistortion& lens) {
    std::vector<double> coefficients = {lens.k1, lens.k2, lens.p1, lens.p2};
    if (lens.k3 != 0) coefficients.push_back(lens.k3);
    return coefficients;
  }

  void operator()(const PinholeProjection& lens) const {
    Write("pinhole", {lens.fx, lens.fy, lens.cx, lens.cy}, "none", {});
  }
  void operator()(const RadTanProjection& lens) const {
    Write("pinhole", {lens.fx, lens.fy, lens.cx, lens.cy}, "radtan", Coefficients(lens.distortion));
  }
  void operator()(const KannalaBrandtProjection& lens) const {
    Write("pinhole", {lens.fx, lens.fy, lens.cx, lens.cy}, "equidistant",
          {lens.k1, lens.k2, lens.k3, lens.k4});
  }
  void operator()(const MeiProjection& lens) const {
    Write("omni", {lens.xi, lens.fx, lens.fy, lens.cx, lens.cy}, "radtan",
          Coefficients(lens.distortion));
  }
  void operator()(const EucmProjection& lens) const {
    Write("eucm", {lens.alpha, lens.beta, lens.fx, lens.fy, lens.cx, lens.cy}, "none", {});
  }
  void operator()(const DoubleSphereProjection& lens) const {
    Write("ds", {lens.xi, lens.alpha, lens.fx, lens.fy, lens.cx, lens.cy}, "none", {});
  }
  void operator()(const OcamProjection& lens) const {
    Write("ocam", {lens.a0, lens.a2, lens.a3, lens.a4}, "none", {});
    WriteNumbers(out, "centre", {lens.cx, lens.cy});
    WriteNumbers(out, "affine", {lens.c, lens.d, lens.e});
  }
};

void WriteCamera(YAML::Emitter& out, const Rig& rig, const RigCamera& camera) {
  out << YAML::Key << camera.name << YAML::Value << YAML::BeginMap;
  std::visit(LensWriter{out}, camera.model.projection());
  out << YAML::Key << "resolution" << YAML::Value << YAML::Flow
      << std::vector<int>{camera.model.width(), camera.model.height()};
  if (!camera.topic.empty()) out << YAML::Key << "rostopic" << YAML::Value << camera.topic;
  out << YAML::Key << "timeshift_cam_imu" << YAML::Value << camera.time_shift;
  if (camera.line_delay != 0) out << YAML::Key << "line_delay" << YAML::Value << camera.line_delay;
  if (!camera.mask.empty()) out << YAML::Key << "mask" << YAML::Value << camera.name + "_mask.png";
  WriteMotion(out, "T_cam_imu", camera.body_from_camera.Inverse() * rig.body_from_imu);
  out << YAML::EndMap;
}

void StartMap(YAML::Emitter& out) {
  out.SetDoublePrecision(17);
  out << YAML::BeginMap;
}

void Finish(YAML::Emitter& out, const path& file) {
  out << YAML::EndMap << YAML::Newline;
  WriteFileAtomically(file, std::string_view(out.c_str(), out.size()));
}

/// Calibration tools know no such key: it is written where it says something.
void WriteScale(YAML::Emitter& out, const char* key, double scale) {
  if (scale != 1) out << YAML::Key << key << YAML::Value << scale;
}

void WriteImu(const ImuCalibration& imu, const path& file) {
  YAML::Emitter out;
  StartMap(out);
  if (!imu.topic.empty()) out << YAML::Key << "rostopic" << YAML::Value << imu.topic;
  const std::pair<const char*, double> numbers[] = {
      {"update_rate", imu.update_rate},
      {"accelerometer_noise_density", imu.accelerometer_noise_density},
      {"accelerometer_random_walk", imu.accelerometer_random_walk},
      {"gyroscope_noise_density", imu.gyroscope_noise_density},
      {"gyroscope_random_walk", imu.gyroscope_random_walk}};
  for (const auto& [key, value] : numbers) out << YAML::Key << key << YAML::Value << value;
  WriteScale(out, "accelerometer_scale", imu.accelerometer_scale);
  WriteScale(out, "gyroscope_scale", imu.gyroscope_scale);
  Finish(out, file);
}

void WriteVehicle(const Rig& rig, const path& file) {
  YAML::Emitter out;
  StartMap(out);
  WriteMotion(out, "T_imu_body", rig.body_from_imu.Inverse());
  out << YAML::Key << "wheelbase" << YAML::Value << rig.vehicle->wheelbase;
  out << YAML::Key << "track" << YAML::Value << rig.vehicle->track;
  if (!rig.vehicle->wheel_topic.empty())
    out << YAML::Key << "wheel_topic" << YAML::Value << rig.vehicle->wheel_topic;
  if (!rig.vehicle->gnss_topic.empty())
    out << YAML::Key << "gnss_topic" << YAML::Value << rig.vehicle->gnss_topic;
  WriteScale(out, "wheel_scale", rig.vehicle->wheel_scale);
  if (const auto& antenna = rig.vehicle->antenna_in_body)
    WriteNumbers(out, "p_body_gnss", {antenna->x(), antenna->y(), antenna->z()});
  WriteFieldMap(out, rig.vehicle->fields);
  Finish(out, file);
}

}  // namespace

void WriteRig(const Rig& rig, const path& folder) {
  Require(rig.vehicle || rig.body_from_imu.Matrix().isIdentity(1e-12), ErrorCode::kInternal,
          "a rig without a vehicle has the IMU as its body");
  for (const RigCamera& camera : rig.cameras) {
    if (camera.mask.empty()) continue;
    std::vector<unsigned char> png;
    cv::imencode(".png", camera.mask, png);
    WriteFileAtomically(folder / (camera.name + "_mask.png"),
                        std::string_view(reinterpret_cast<const char*>(png.data()), png.size()));
  }
  YAML::Emitter out;
  StartMap(out);
  for (const RigCamera& camera : rig.cameras) WriteCamera(out, rig, camera);
  Finish(out, folder / "camchain-imucam.yaml");
  WriteImu(rig.imu, folder / "imu0.yaml");
  if (rig.vehicle) WriteVehicle(rig, folder / "vehicle.yaml");
}

}  // namespace parkade
