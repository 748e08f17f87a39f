#include "tests/simulator/sinks/euroc_sink.h"

#include <cstdarg>
#include <cstdio>
#include <sstream>
#include <variant>

#include "core/error.h"
#include "core/files/file.h"

namespace parkade::simulator {
namespace {

namespace fs = std::filesystem;

std::string Format(const char* format, ...) __attribute__((format(printf, 1, 2)));
std::string Format(const char* format, ...) {
  char text[512];
  va_list values;
  va_start(values, format);
  std::vsnprintf(text, sizeof text, format, values);
  va_end(values);
  return text;
}

std::string BodyFromSensorText(const Rigid3& body_from_sensor) {
  const Eigen::Matrix4d matrix = body_from_sensor.Matrix();
  std::string text = "T_BS:\n  cols: 4\n  rows: 4\n  data: [";
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      text += Format("%s%.17g", row + column > 0 ? ", " : "", matrix(row, column));
  return text + "]\n";
}

std::string CameraText(const RigCamera& camera) {
  const auto* lens = std::get_if<KannalaBrandtProjection>(&camera.model.projection());
  Require(lens != nullptr, ErrorCode::kInternal,
          "EuRoC folders are written for Kannala-Brandt lenses only");
  return "sensor_type: camera\ncomment: simulated fisheye\n" +
         BodyFromSensorText(camera.body_from_camera) +
         Format("resolution: [%d, %d]\ncamera_model: pinhole\n", camera.model.width(),
                camera.model.height()) +
         Format("intrinsics: [%.17g, %.17g, %.17g, %.17g]\ndistortion_model: equidistant\n",
                lens->fx, lens->fy, lens->cx, lens->cy) +
         Format("distortion_coefficients: [%.17g, %.17g, %.17g, %.17g]\n", lens->k1, lens->k2,
                lens->k3, lens->k4);
}

std::string ImuText(const Rig& rig) {
  return "sensor_type: imu\ncomment: simulated IMU\n" + BodyFromSensorText(rig.body_from_imu) +
         Format("rate_hz: %.17g\n", rig.imu.update_rate) +
         Format("gyroscope_noise_density: %.17g\ngyroscope_random_walk: %.17g\n",
                rig.imu.gyroscope_noise_density, rig.imu.gyroscope_random_walk) +
         Format("accelerometer_noise_density: %.17g\naccelerometer_random_walk: %.17g\n",
                rig.imu.accelerometer_noise_density, rig.imu.accelerometer_random_walk);
}

}  // namespace

EurocSink::EurocSink(const fs::path& folder, const Rig& rig)
    : root_(folder / "mav0"),
      imu_{
          root_ / "imu0",
          "#timestamp [ns],w_x [rad/s],w_y [rad/s],w_z [rad/s],a_x [m/s^2],a_y [m/s^2],a_z [m/s^2]",
          {}},
      wheels_{root_ / "odom0", "#timestamp [ns],v_x [m/s],w_z [rad/s]", {}},
      gnss_{root_ / "gnss0",
            "#timestamp [ns],lat [deg],lon [deg],alt [m],sigma_e [m],sigma_n [m],sigma_u [m]",
            {}} {
  for (const RigCamera& camera : rig.cameras) {
    images_.push_back({root_ / camera.name, "#timestamp [ns],filename", {}});
    masks_.push_back({root_ / camera.name / "semantic", "#timestamp [ns],filename", {}});
    fs::create_directories(images_.back().folder / "data");
    WriteFileAtomically(images_.back().folder / "sensor.yaml", CameraText(camera));
  }
  fs::create_directories(imu_.folder);
  WriteFileAtomically(imu_.folder / "sensor.yaml", ImuText(rig));
}

void EurocSink::WriteLine(Table& table, const std::string& line) {
  if (!table.file.is_open()) {
    fs::create_directories(table.folder);
    table.file.open(table.folder / "data.csv", std::ios::binary);
    table.file << table.header << '\n';
  }
  table.file << line << '\n';
}

void EurocSink::Write(const ImuSample& sample) {
  const Eigen::Vector3d &w = sample.angular_velocity, &a = sample.linear_acceleration;
  WriteLine(imu_,
            std::to_string(sample.time.ns) + Format(",%.12g,%.12g,%.12g,%.12g,%.12g,%.12g", w.x(),
                                                    w.y(), w.z(), a.x(), a.y(), a.z()));
}

void EurocSink::Write(const WheelSample& sample) {
  WriteLine(wheels_, std::to_string(sample.time.ns) +
                         Format(",%.9g,%.9g", sample.forward_speed, sample.yaw_rate));
}

void EurocSink::Write(const GnssFix& fix) {
  const Eigen::Vector3d& sigma = fix.sigma_enu;
  WriteLine(gnss_, std::to_string(fix.time.ns) +
                       Format(",%.10f,%.10f,%.4f,%.4f,%.4f,%.4f", fix.latitude_deg,
                              fix.longitude_deg, fix.altitude, sigma.x(), sigma.y(), sigma.z()));
}

void EurocSink::WriteFrame(Table& table, Timestamp time, const char* suffix,
                           std::span<const std::uint8_t> content) {
  const std::string name = std::to_string(time.ns) + suffix;
  fs::create_directories(table.folder / "data");
  std::ofstream file(table.folder / "data" / name, std::ios::binary);
  file.write(reinterpret_cast<const char*>(content.data()),
             static_cast<std::streamsize>(content.size()));
  Require(file.good(), ErrorCode::kDiskFull, "the image " + name + " could not be written");
  WriteLine(table, std::to_string(time.ns) + "," + name);
}

void EurocSink::WriteImage(size_t camera, Timestamp time, std::span<const std::uint8_t> jpeg) {
  WriteFrame(images_[camera], time, ".jpg", jpeg);
}
void EurocSink::WriteSemantic(size_t camera, Timestamp time, std::span<const std::uint8_t> png) {
  WriteFrame(masks_[camera], time, ".png", png);
}

void EurocSink::Close() {
  std::vector<Table*> tables = {&imu_, &wheels_, &gnss_};
  for (Table& table : images_) tables.push_back(&table);
  for (Table& table : masks_) tables.push_back(&table);
  for (Table* table : tables) {
    if (!table->file.is_open()) continue;
    table->file.close();
    Require(table->file.good(), ErrorCode::kDiskFull,
            (table->folder / "data.csv").filename().string() + " could not be written whole");
  }
}

}  // namespace parkade::simulator
