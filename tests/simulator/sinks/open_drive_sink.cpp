#include "tests/simulator/sinks/open_drive_sink.h"

#include "core/error.h"
#include "tests/simulator/sinks/euroc_sink.h"
#include "tests/simulator/sinks/ros_sink.h"

namespace parkade::simulator {

bool IsLogFile(const std::filesystem::path& out) {
  return out.extension() == ".bag" || out.extension() == ".mcap";
}

void RequireNewOutput(const std::filesystem::path& out) {
  const bool is_new = !std::filesystem::exists(out) ||
                      (std::filesystem::is_directory(out) && std::filesystem::is_empty(out));
  Require(is_new, ErrorCode::kUsage, out.string() + " exists already");
}

std::unique_ptr<DriveSink> OpenDriveSink(const std::filesystem::path& out, const Rig& rig) {
  RequireNewOutput(out);
  if (IsLogFile(out)) return std::make_unique<RosSink>(out, rig);
  return std::make_unique<EurocSink>(out, rig);
}

Rig RigForOutput(const Rig& rig, const std::filesystem::path& out) {
  Rig named = rig;
  if (IsLogFile(out)) return named;
  for (RigCamera& camera : named.cameras) camera.topic = camera.name;
  named.imu.topic = "imu0";
  if (!named.vehicle->wheel_topic.empty()) named.vehicle->wheel_topic = "odom0";
  if (!named.vehicle->gnss_topic.empty()) named.vehicle->gnss_topic = "gnss0";
  return named;
}

}  // namespace parkade::simulator
