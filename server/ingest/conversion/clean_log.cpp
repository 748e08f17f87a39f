#include "server/ingest/conversion/clean_log.h"

#include <algorithm>
#include <string_view>

#include "server/ingest/drive/stream_selection.h"

namespace parkade {
namespace {

/// Empty where no stream is of the kind.
std::string TopicOf(StreamKind kind, int camera, const std::vector<SensorStream>& streams) {
  const auto found = std::find_if(streams.begin(), streams.end(), [&](const SensorStream& stream) {
    return stream.kind == kind && stream.camera == camera;
  });
  return found == streams.end() ? "" : CleanTopic(*found);
}

}  // namespace

std::string CleanTopic(const SensorStream& stream) {
  constexpr std::string_view kOfFieldMap = "fields/";
  std::string_view name = PlainTopic(stream.topic_name);
  if (name.starts_with(kOfFieldMap)) name.remove_prefix(kOfFieldMap.size());
  return std::string("/").append(name);
}

Rig CleanRig(Rig rig, const std::vector<SensorStream>& streams) {
  std::vector<RigCamera> cameras;
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    RigCamera camera = rig.cameras[i];
    camera.topic = TopicOf(StreamKind::kImage, static_cast<int>(i), streams);
    camera.time_shift = 0;
    if (!camera.topic.empty()) cameras.push_back(camera);
  }
  rig.cameras = std::move(cameras);
  rig.imu.topic = TopicOf(StreamKind::kImu, -1, streams);
  rig.imu.accelerometer_scale = rig.imu.gyroscope_scale = 1;
  if (!rig.vehicle) return rig;
  rig.vehicle->wheel_topic = TopicOf(StreamKind::kWheels, -1, streams);
  rig.vehicle->gnss_topic = TopicOf(StreamKind::kGnss, -1, streams);
  rig.vehicle->wheel_scale = 1;
  rig.vehicle->fields = {};
  return rig;
}

}  // namespace parkade
