#include "server/ingest/drive/rig_discovery.h"

#include <algorithm>
#include <map>
#include <set>

#include "core/error.h"
#include "core/math/statistics.h"
#include "server/ingest/drive/stream_selection.h"
#include "server/ingest/messages/camera_info_model.h"
#include "server/ingest/messages/message_decoding.h"
#include "server/ingest/messages/transform_graph.h"

namespace parkade {
namespace {

struct CameraTopics {
  std::string folder;  ///< "cam_left"
  int image_topic = -1, info_topic = -1;
  std::string image_name;
  std::optional<std::string> frame;
  std::optional<CameraInfoMessage> info;
};

std::string LastPart(std::string_view topic) {
  return std::string(topic.substr(topic.rfind('/') + 1));
}

std::string FolderOf(std::string_view topic) {
  const std::size_t slash = topic.rfind('/');
  return slash == std::string_view::npos ? "" : std::string(topic.substr(0, slash));
}

/// "cam_left" of "cam_left/image_raw"; a topic with a name of its own, as "cam_left", is the camera
/// itself, unless a CameraInfo lies beside it.
std::string CameraOf(std::string_view plain_topic, const std::set<std::string>& folders_with_info) {
  const std::string folder = FolderOf(plain_topic);
  const bool is_in_folder =
      LastPart(plain_topic).starts_with("image") || folders_with_info.contains(folder);
  return is_in_folder ? folder : std::string(plain_topic);
}

bool IsRectified(const std::string& topic) {
  return LastPart(PlainTopic(topic)).starts_with("image_rect");
}

/// Collects the parts of a rig as messages pass.
class RigCollector {
 public:
  explicit RigCollector(const MessageSource& source) : topics_(source.topics()) {
    std::set<std::string> folders_with_info;
    for (const auto& topic : topics_)
      if (topic.type == "sensor_msgs/CameraInfo")
        folders_with_info.insert(FolderOf(PlainTopic(topic.topic)));
    std::map<std::string, CameraTopics> cameras;
    std::vector<std::string> imus;
    const bool has_index = std::any_of(topics_.begin(), topics_.end(), [](const TopicInfo& topic) {
      return topic.num_messages > 0;
    });
    for (std::size_t i = 0; i < topics_.size(); ++i) {
      if (has_index && topics_[i].num_messages == 0)
        continue;  // it was announced, and nothing came
      const std::string& type = topics_[i].type;
      if (type == "sensor_msgs/Imu") {
        imu_topic_ = static_cast<int>(i);
        imus.push_back(topics_[i].topic);
      }
      const std::string_view plain = PlainTopic(topics_[i].topic);
      if (type == "sensor_msgs/CameraInfo")
        cameras[FolderOf(plain)].info_topic = static_cast<int>(i);
      if (IsImageType(type) && LastPart(plain) != "semantic" &&
          LastPart(plain) != "compressedDepth")
        AddImageTopic(cameras[CameraOf(plain, folders_with_info)], i);
      if (type == "tf2_msgs/TFMessage" &&
          (plain.ends_with("tf_static") || !topics_[i].native_type.empty()))
        transform_topics_.push_back(static_cast<int>(i));
    }
    for (auto& [folder, camera] : cameras) {
      camera.folder = folder;
      if (camera.image_topic >= 0) cameras_.push_back(camera);
    }
    Require(!cameras_.empty(), ErrorCode::kInvalidInput, "the log has no images");
    Require(imu_topic_ >= 0, ErrorCode::kInvalidInput,
            "the log has no IMU (no topic of type sensor_msgs/Imu)");
    Require(imus.size() == 1, ErrorCode::kInvalidInput,
            "no rig: the log has several IMUs (" + ListTopics(imus) +
                "): bring a rig whose imu0.yaml names one");
  }

  std::vector<bool> WantedTopics() const {
    std::vector<bool> wanted(topics_.size(), false);
    wanted[static_cast<std::size_t>(imu_topic_)] = true;
    for (const int topic : transform_topics_) wanted[static_cast<std::size_t>(topic)] = true;
    for (const CameraTopics& camera : cameras_) {
      wanted[static_cast<std::size_t>(camera.image_topic)] = true;
      if (camera.info_topic >= 0) wanted[static_cast<std::size_t>(camera.info_topic)] = true;
    }
    return wanted;
  }

  void Include(const RawMessage& message) {
    const TopicInfo& topic = topics_[static_cast<std::size_t>(message.topic)];
    const MessageEncoding encoding = topic.encoding;
    if (std::find(transform_topics_.begin(), transform_topics_.end(), message.topic) !=
        transform_topics_.end()) {
      for (const TransformMessage& transform : DecodeTransforms(message.data, encoding))
        transforms_.Add(transform);
      has_news_ = true;
    }
    if (message.topic == imu_topic_) {
      const MessageHeader header = DecodeHeader(message.data, encoding, topic.type);
      imu_frame_ = header.frame_id;
      if (imu_stamps_.size() < kEnoughStamps)
        imu_stamps_.push_back(header.stamp.ns == 0 ? message.log_time : header.stamp);
      if (imu_stamps_.size() == kEnoughStamps) has_news_ = true;
    }
    for (CameraTopics& camera : cameras_) {
      const bool is_first_image = message.topic == camera.image_topic && !camera.frame;
      const bool is_first_info = message.topic == camera.info_topic && !camera.info;
      if (is_first_image) camera.frame = DecodeHeader(message.data, encoding, topic.type).frame_id;
      if (is_first_info) camera.info = DecodeCameraInfo(message.data, encoding);
      has_news_ = has_news_ || is_first_image || is_first_info;
    }
  }

  /// True when the rest of the log can add nothing.
  bool IsComplete() {
    if (!std::exchange(has_news_, false) || imu_stamps_.size() < kEnoughStamps) return false;
    return FindMissing().empty() && BodyFrame();
  }

  /// One phrase for each thing that is missing.
  std::vector<std::string> FindMissing() const {
    if (!imu_frame_) return {"the IMU topic has no message"};
    std::vector<std::string> missing, frames;
    if (PlainFrame(*imu_frame_).empty()) missing.push_back("the messages of the IMU name no frame");
    for (const CameraTopics& camera : cameras_) {
      if (!camera.info) missing.push_back("camera /" + camera.folder + " has no CameraInfo");
      const std::string frame = FrameOf(camera);
      if (frame.empty())
        missing.push_back("the images of camera /" + camera.folder + " name no frame");
      else if (!PlainFrame(*imu_frame_).empty() && !transforms_.Find(*imu_frame_, frame))
        frames.push_back(frame);
    }
    if (!frames.empty())
      missing.push_back("/tf_static has no transform from " + PlainFrame(*imu_frame_) + " to " +
                        ListTopics(frames));
    return missing;
  }

  Rig MakeRig() const {
    Rig rig;
    rig.imu.topic = topics_[static_cast<std::size_t>(imu_topic_)].topic;
    rig.imu.update_rate = ImuRate().value_or(rig.imu.update_rate);
    if (BodyFrame()) rig.vehicle = VehicleCalibration{};
    const std::string body = BodyFrame().value_or(*imu_frame_);
    rig.body_from_imu = *transforms_.Find(body, *imu_frame_);
    for (const CameraTopics& topics : cameras_) {
      RigCamera camera;
      camera.name = "cam" + std::to_string(rig.cameras.size());
      camera.topic = topics.image_name;
      camera.model = ModelFromCameraInfo(*topics.info, IsRectified(topics.image_name),
                                         "camera /" + topics.folder);
      camera.body_from_camera = *transforms_.Find(body, FrameOf(topics));
      rig.cameras.push_back(std::move(camera));
    }
    ValidateRig(rig);
    return rig;
  }

 private:
  static constexpr std::size_t kEnoughStamps = 100;

  void AddImageTopic(CameraTopics& camera, std::size_t index) {
    const std::string& name = topics_[index].topic;
    const bool is_better =
        camera.image_topic < 0 || (IsRectified(camera.image_name) && !IsRectified(name));
    if (!is_better) return;
    camera.image_topic = static_cast<int>(index);
    camera.image_name = name;
  }

  static std::string FrameOf(const CameraTopics& camera) {
    if (camera.frame && !camera.frame->empty()) return PlainFrame(*camera.frame);
    return camera.info ? PlainFrame(camera.info->header.frame_id) : "";
  }

  std::optional<std::string> BodyFrame() const {
    for (const char* frame : {"rear_axle", "base_footprint", "base_link"})
      if (transforms_.Find(*imu_frame_, frame)) return frame;
    return std::nullopt;
  }

  /// The rate [Hz] by the median step between stamps.
  std::optional<double> ImuRate() const {
    std::vector<double> steps;
    for (std::size_t i = 1; i < imu_stamps_.size(); ++i)
      if (imu_stamps_[i] > imu_stamps_[i - 1]) steps.push_back(imu_stamps_[i] - imu_stamps_[i - 1]);
    if (steps.empty()) return std::nullopt;
    return 1 / Median(std::move(steps));
  }

  const std::vector<TopicInfo>& topics_;
  std::vector<CameraTopics> cameras_;
  int imu_topic_ = -1;
  std::vector<int> transform_topics_;
  std::optional<std::string> imu_frame_;
  std::vector<Timestamp> imu_stamps_;  ///< the first ones
  TransformGraph transforms_;
  bool has_news_ = false;  ///< since completeness was last looked at
};

}  // namespace

Rig DiscoverRig(const MessageSource& source) {
  RigCollector collector(source);
  const auto stream = source.Read(collector.WantedTopics());
  while (const std::optional<RawMessage> message = stream->Next()) {
    try {
      collector.Include(*message);
    } catch (const Error&) {
      continue;  // a damaged message tells nothing about the rig; the survey counts it
    }
    if (collector.IsComplete()) break;
  }
  const std::vector<std::string> missing = collector.FindMissing();
  Require(missing.empty(), ErrorCode::kInvalidInput, "no rig: " + ListTopics(missing));
  return collector.MakeRig();
}

}  // namespace parkade
