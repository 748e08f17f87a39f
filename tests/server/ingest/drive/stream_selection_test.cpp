#include "server/ingest/drive/stream_selection.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace parkade {
namespace {

/// A log of which only the topics are asked for.
class TopicsOnly final : public MessageSource {
 public:
  explicit TopicsOnly(std::vector<TopicInfo> topics) : topics_(std::move(topics)) {}
  const std::vector<TopicInfo>& topics() const override { return topics_; }
  std::string format() const override { return "MCAP"; }
  std::unique_ptr<MessageStream> Read(const std::vector<bool>&) const override { return nullptr; }
  std::optional<RawMessage> ReadAt(int, const MessagePlace&) const override { return {}; }

 private:
  std::vector<TopicInfo> topics_;
};

Rig RigOf(const std::vector<std::pair<std::string, std::string>>& cameras) {
  Rig rig;
  for (const auto& [name, topic] : cameras) {
    RigCamera& camera = rig.cameras.emplace_back();
    camera.name = name;
    camera.topic = topic;
  }
  return rig;
}

/// Topics of the masks, by camera.
std::map<int, std::string> MasksOf(const MessageSource& log, const Rig& rig) {
  std::map<int, std::string> masks;
  for (const SensorStream& stream : SelectStreams(log, rig, false, false).streams)
    if (stream.kind == StreamKind::kSemantic)
      masks[stream.camera] = log.topics()[static_cast<size_t>(stream.topic)].topic;
  return masks;
}

TEST(StreamSelection, MasksFollowTheTopicsHoweverTheRigCounts) {
  std::vector<TopicInfo> topics = {{"/imu", "sensor_msgs/Imu"}};
  for (const std::string camera : {"/cam1", "/cam2", "/cam3"}) {
    topics.push_back({camera + "/image_raw", "sensor_msgs/Image"});
    topics.push_back({camera + "/semantic", "sensor_msgs/Image"});
  }

  const auto masks = MasksOf(TopicsOnly(topics), RigOf({{"cam0", "/cam1/image_raw"},
                                                        {"cam1", "/cam2/image_raw"},
                                                        {"cam2", "/cam3/image_raw"}}));

  EXPECT_EQ(masks, (std::map<int, std::string>{
                       {0, "/cam1/semantic"}, {1, "/cam2/semantic"}, {2, "/cam3/semantic"}}));
}

TEST(StreamSelection, MasksMayGoByTheCamerasNames) {
  const TopicsOnly log({{"/imu", "sensor_msgs/Imu"},
                        {"/front/image", "sensor_msgs/Image"},
                        {"/rear/image", "sensor_msgs/Image"},
                        {"/cam1/semantic", "sensor_msgs/Image"}});

  const auto masks = MasksOf(log, RigOf({{"cam0", "/front/image"}, {"cam1", "/rear/image"}}));

  EXPECT_EQ(masks, (std::map<int, std::string>{{1, "/cam1/semantic"}}));
}

TEST(StreamSelection, AMaskBelongsToOneCamera) {
  const TopicsOnly log({{"/imu", "sensor_msgs/Imu"},
                        {"/cam1/image_raw", "sensor_msgs/Image"},
                        {"/cam2/image_raw", "sensor_msgs/Image"},
                        {"/cam1/semantic", "sensor_msgs/Image"}});

  const auto masks =
      MasksOf(log, RigOf({{"cam0", "/cam1/image_raw"}, {"cam1", "/cam2/image_raw"}}));

  EXPECT_EQ(masks, (std::map<int, std::string>{{0, "/cam1/semantic"}}));
}

const std::vector<TopicInfo> kTwoOfEach = {{"/imu/a", "sensor_msgs/Imu"},
                                           {"/imu/b", "sensor_msgs/Imu"},
                                           {"/left", "sensor_msgs/Image"},
                                           {"/right", "sensor_msgs/Image"}};

/// What selecting throws.
std::string ErrorOf(const std::vector<TopicInfo>& topics, const Rig& rig) {
  try {
    SelectStreams(TopicsOnly(topics), rig, false, false);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidInput);
    return error.what();
  }
  return "";
}

TEST(StreamSelection, TheOnlyImuNeedsNoName) {
  const TopicsOnly log({{"/left", "sensor_msgs/Image"}, {"/imu/data", "sensor_msgs/Imu"}});

  const StreamSelection selection = SelectStreams(log, RigOf({{"cam0", "/left"}}), false, false);

  EXPECT_EQ(selection.streams.front().topic_name, "/imu/data");
  EXPECT_EQ(ErrorOf(kTwoOfEach, RigOf({{"cam0", "/left"}})),
            "the log has several IMUs (/imu/a and /imu/b): name one as rostopic in imu0.yaml");
}

TEST(StreamSelection, ACameraWithoutATopicIsThatOfItsNameOrIsNamed) {
  const std::vector<TopicInfo> topics = {{"/imu", "sensor_msgs/Imu"},
                                         {"/cam0/compressed", "sensor_msgs/CompressedImage"},
                                         {"/rear", "sensor_msgs/Image"}};

  const StreamSelection selection =
      SelectStreams(TopicsOnly(topics), RigOf({{"cam0", ""}, {"cam1", "/rear"}}), false, false);

  EXPECT_EQ(selection.streams[1].topic_name, "/cam0/compressed");
  EXPECT_EQ(ErrorOf(topics, RigOf({{"cam0", ""}, {"cam1", ""}})),
            "the rig's camera chain has no 'rostopic' of cam1: name one of the log's image topics, "
            "which are /cam0/compressed and /rear");
}

}  // namespace
}  // namespace parkade
