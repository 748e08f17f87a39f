#include "server/write_calibration.h"

#include <yaml-cpp/yaml.h>

#include <string>

#include "core/file.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

/// The rig's own files, made beside `file` and gone with this object.
class RigFiles {
 public:
  RigFiles(const Rig& rig, const fs::path& file) : folder_(file.parent_path() / ".calibration") {
    fs::create_directories(folder_);
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

}  // namespace

void WriteCalibration(const Rig& rig, const fs::path& file) {
  const RigFiles files(rig, file);
  YAML::Node calibration = files.Load("camchain-imucam.yaml");
  for (const RigCamera& camera : rig.cameras) {
    calibration[camera.name].remove("mask");  // an image file of the rig's folder, not of the map's
    calibration[camera.name]["status"] = "kept";
  }
  calibration["imu0"] = files.Load("imu0.yaml");
  calibration["imu0"]["status"] = "kept";
  if (rig.vehicle) {
    calibration["vehicle"] = files.Load("vehicle.yaml");
    calibration["vehicle"]["status"] = "kept";
  }
  YAML::Emitter text;
  text << calibration;
  WriteFileAtomically(file, std::string(text.c_str()) + "\n");
}

}  // namespace parkade
