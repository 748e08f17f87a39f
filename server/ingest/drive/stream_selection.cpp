#include "server/ingest/drive/stream_selection.h"

#include <algorithm>

#include "core/error.h"
#include "server/ingest/messages/message_decoding.h"

namespace parkade {
namespace {

class Selector {
 public:
  explicit Selector(const MessageSource& source) : topics_(source.topics()) {
    is_euroc_ = !topics_.empty() && topics_.front().encoding == MessageEncoding::kEuroc;
  }

  bool is_euroc() const { return is_euroc_; }

  template <typename IsType>
  std::vector<std::string> TopicsOf(const IsType& is_type) const {
    std::vector<std::string> names;
    for (const TopicInfo& topic : topics_)
      if (is_type(topic.type)) names.push_back(topic.topic);
    return names;
  }

  /// Index of the topic that matches, the exact spelling first, or -1.
  template <typename IsType>
  int Find(const std::string& name, const IsType& is_type) const {
    int found = -1;
    for (std::size_t i = 0; i < topics_.size(); ++i) {
      if (!is_type(topics_[i].type) || PlainTopic(topics_[i].topic) != PlainTopic(name)) continue;
      if (topics_[i].topic == name) return static_cast<int>(i);
      if (found < 0) found = static_cast<int>(i);
    }
    return found;
  }

  SensorStream Make(StreamKind kind, int topic, const std::string& role) const {
    const TopicInfo& info = topics_[static_cast<std::size_t>(topic)];
    SensorStream stream;
    stream.kind = kind;
    stream.topic = topic;
    stream.role = role;
    stream.topic_name = info.topic;
    stream.type = info.type;
    stream.encoding = info.encoding;
    return stream;
  }

 private:
  const std::vector<TopicInfo>& topics_;
  bool is_euroc_ = false;
};

Finding Note(std::string name, std::string topic, std::string sentence) {
  return {std::move(name), Severity::kNote, std::move(topic), std::move(sentence), "", {}};
}

bool IsImuType(const std::string& type) { return type == "sensor_msgs/Imu"; }
bool IsGnssType(const std::string& type) { return type == "sensor_msgs/NavSatFix"; }

int FindImu(const Selector& log, const Rig& rig) {
  const std::vector<std::string> candidates = log.TopicsOf(IsImuType);
  Require(!candidates.empty(), ErrorCode::kInvalidInput,
          "the log has no IMU (no topic of type sensor_msgs/Imu)");
  const std::string wanted = log.is_euroc() ? "imu0" : rig.imu.topic;
  if (wanted.empty()) {
    Require(candidates.size() == 1, ErrorCode::kInvalidInput,
            "the log has several IMUs (" + ListTopics(candidates) +
                "): name one as rostopic in imu0.yaml");
    return log.Find(candidates.front(), IsImuType);
  }
  const int found = log.Find(wanted, IsImuType);
  Require(
      found >= 0, ErrorCode::kInvalidInput,
      "the rig's IMU topic " + wanted + " is not in the log, which has " + ListTopics(candidates));
  return found;
}

/// A wheel or GNSS topic, which a drive can do without.
template <typename IsType>
int FindOptional(const Selector& log, const std::string& wanted, const std::string& what,
                 const IsType& is_type, std::vector<Finding>& findings) {
  const std::vector<std::string> candidates = log.TopicsOf(is_type);
  if (!wanted.empty()) {
    const int found = log.Find(wanted, is_type);
    if (found < 0 && !log.is_euroc())
      findings.push_back(Note("topic_missing", wanted,
                              "the rig's " + what + " topic " + wanted +
                                  " is not in the log, which has " + ListTopics(candidates)));
    return found;
  }
  if (candidates.size() == 1) return log.Find(candidates.front(), is_type);
  if (candidates.size() > 1)
    findings.push_back(Note("topic_ambiguous", "",
                            "several " + what + " topics (" + ListTopics(candidates) +
                                "), none is used: name one in vehicle.yaml"));
  return -1;
}

std::string FolderOf(std::string_view topic) {
  const std::size_t slash = topic.rfind('/');
  return std::string(topic.substr(0, slash == std::string_view::npos ? 0 : slash));
}

/// Whether a topic name starts as another camera's: rigs number their cameras from 0, logs often
/// from 1.
bool IsOfOtherCamera(const std::string& name, const RigCamera& camera, const Rig& rig) {
  return std::any_of(rig.cameras.begin(), rig.cameras.end(), [&](const RigCamera& other) {
    const std::string topic(PlainTopic(other.topic));
    return other.name != camera.name && (topic == name || FolderOf(topic) == name);
  });
}

int FindMask(const Selector& log, const RigCamera& camera, const Rig& rig) {
  const std::string topic(PlainTopic(camera.topic));
  std::vector<std::string> names;
  if (!log.is_euroc()) names = {FolderOf(topic), topic};
  if (log.is_euroc() || !IsOfOtherCamera(camera.name, camera, rig)) names.push_back(camera.name);
  for (const std::string& name : names) {
    const int found = name.empty() ? -1 : log.Find(name + "/semantic", IsImageType);
    if (found >= 0) return found;
  }
  return -1;
}

void AddCameras(const Selector& log, const Rig& rig, StreamSelection& selection) {
  std::vector<SensorStream> masks;
  std::vector<std::string> missing, unnamed;
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    const RigCamera& camera = rig.cameras[i];
    const bool is_named = !log.is_euroc() && !camera.topic.empty();
    const std::string wanted = is_named ? camera.topic : camera.name;
    const int image = log.Find(wanted, IsImageType);
    if (image < 0 && !is_named && !log.is_euroc()) unnamed.push_back(camera.name);
    if (image < 0) {
      missing.push_back(camera.name + " (" + wanted + ")");
      continue;
    }
    selection.streams.push_back(log.Make(StreamKind::kImage, image, camera.name));
    selection.streams.back().camera = static_cast<int>(i);
    selection.streams.back().time_shift = camera.time_shift;
    if (const int mask = FindMask(log, camera, rig); mask >= 0) {
      masks.push_back(log.Make(StreamKind::kSemantic, mask, camera.name + "/semantic"));
      masks.back().camera = static_cast<int>(i);
      masks.back().time_shift = camera.time_shift;
    }
  }
  const std::vector<std::string> candidates = log.TopicsOf(IsImageType);
  Require(!candidates.empty(), ErrorCode::kInvalidInput, "the log has no images");
  Require(unnamed.empty(), ErrorCode::kInvalidInput,
          "the rig's camera chain has no 'rostopic' of " + ListTopics(unnamed) +
              ": name one of the log's image topics, which are " + ListTopics(candidates));
  Require(missing.size() < rig.cameras.size(), ErrorCode::kInvalidInput,
          "none of the rig's cameras is in the log: the rig has " + ListTopics(missing) +
              ", the log " + ListTopics(candidates));
  for (const std::string& camera : missing)
    selection.findings.push_back(
        Note("camera_missing", camera, "the log has no images of camera " + camera));
  std::move(masks.begin(), masks.end(), std::back_inserter(selection.streams));
}

}  // namespace

std::string_view PlainTopic(std::string_view topic) {
  if (topic.starts_with('/')) topic.remove_prefix(1);
  for (const std::string_view suffix : {"/compressed", "/ffmpeg"}) {
    if (!topic.ends_with(suffix)) continue;
    topic.remove_suffix(suffix.size());
    break;
  }
  return topic;
}

std::string ListTopics(const std::vector<std::string>& topics) {
  if (topics.empty()) return "none";
  std::string list = topics.front();
  for (std::size_t i = 1; i < topics.size(); ++i)
    list += (i + 1 < topics.size() ? ", " : " and ") + topics[i];
  return list;
}

StreamSelection SelectStreams(const MessageSource& source, const Rig& rig, bool use_wheels,
                              bool use_gnss) {
  const Selector log(source);
  StreamSelection selection;
  selection.streams.push_back(log.Make(StreamKind::kImu, FindImu(log, rig), "imu"));
  selection.streams.back().acceleration_scale = rig.imu.accelerometer_scale;
  selection.streams.back().rate_scale = rig.imu.gyroscope_scale;
  const VehicleCalibration vehicle = rig.vehicle.value_or(VehicleCalibration{});
  if (use_wheels) {
    const int topic = FindOptional(log, log.is_euroc() ? "odom0" : vehicle.wheel_topic, "wheel",
                                   IsWheelType, selection.findings);
    if (topic >= 0 && rig.vehicle) {
      selection.streams.push_back(log.Make(StreamKind::kWheels, topic, "wheels"));
      selection.streams.back().speed_scale = vehicle.wheel_scale;
    } else if (topic >= 0) {
      selection.findings.push_back(
          Note("wheels_without_body", "",
               "wheel odometry is not used: no vehicle.yaml says where the body frame is"));
    }
  }
  if (use_gnss) {
    const int topic = FindOptional(log, log.is_euroc() ? "gnss0" : vehicle.gnss_topic, "GNSS",
                                   IsGnssType, selection.findings);
    if (topic >= 0) selection.streams.push_back(log.Make(StreamKind::kGnss, topic, "gnss"));
  }
  AddCameras(log, rig, selection);
  for (const SensorStream& stream : selection.streams)
    if (const TopicInfo& topic = source.topics()[static_cast<std::size_t>(stream.topic)];
        !topic.remark.empty())
      selection.findings.push_back(Note("table_format", topic.topic, topic.remark));
  return selection;
}

}  // namespace parkade
