#include "server/map_folder/write_calibration.h"

#include <yaml-cpp/yaml.h>

#include <string>

#include "core/files/file.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

/// The rig's own files, made beside `file` and gone with this object.
class RigFiles {
 public:
  RigFiles(Rig rig, const fs::path& file) : folder_(file.parent_path() / ".calibration") {
    fs::create_directories(folder_);
    for (RigCamera& camera : rig.cameras)
      camera.mask.release();  // an image file of the rig's folder, not of the map's
    WriteRig(rig, folder_);
  }
  ~RigFiles() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  RigFiles(const RigFiles&) = delete;
  RigFiles& operator=(const RigFiles&) = delete;

  YAML::Node Load(const char* name) const { return YAML::LoadFile(folder_ / name); }

 private:
  fs::path folder_;
};

YAML::Node NumbersOf(const Eigen::VectorXd& vector) {
  YAML::Node node(std::vector<double>(vector.begin(), vector.end()));
  node.SetStyle(YAML::EmitterStyle::Flow);
  return node;
}

void AddCalibration(const CameraCalibration& calibration, YAML::Node camera) {
  for (const CalibratedQuantity& quantity : calibration.quantities) {
    YAML::Node node = camera["calibration"][quantity.name];
    node["status"] = ToText(quantity.status);
    node["change"] = NumbersOf(quantity.change);
    node["sigma"] = NumbersOf(quantity.sigma);
    if (quantity.status != CalibratedQuantity::Status::kKept) camera["status"] = "refined";
  }
}

}  // namespace

void WriteCalibration(const Rig& rig, const std::vector<CameraCalibration>& calibration,
                      const fs::path& file) {
  const RigFiles files(rig, file);
  YAML::Node yaml = files.Load("camchain-imucam.yaml");
  for (size_t i = 0; i < rig.cameras.size(); ++i) {
    const RigCamera& camera = rig.cameras[i];
    yaml[camera.name]["status"] = "kept";
    if (i < calibration.size()) AddCalibration(calibration[i], yaml[camera.name]);
  }
  yaml["imu0"] = files.Load("imu0.yaml");
  yaml["imu0"]["status"] = "kept";
  if (rig.vehicle) {
    yaml["vehicle"] = files.Load("vehicle.yaml");
    yaml["vehicle"]["status"] = "kept";
  }
  YAML::Emitter text;
  text << yaml;
  WriteFileAtomically(file, std::string(text.c_str()) + "\n");
}

}  // namespace parkade
