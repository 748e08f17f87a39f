#include "server/ingest/schemas/translated_source.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "server/ingest/drive/rig_discovery.h"
#include "server/ingest/messages/message_decoding.h"
#include "server/ingest/messages/sensor_decoding.h"
#include "tests/server/ingest/messages/message_writer.h"
#include "tests/server/ingest/schemas/foxglove_log.h"

namespace parkade {
namespace {

using nlohmann::json;

constexpr Timestamp kTime{1'700'000'000'123'456'789};

class TranslatedSourceTest : public testing::TestWithParam<const char*> {
 protected:
  ~TranslatedSourceTest() override { std::filesystem::remove_all(folder_); }

  std::shared_ptr<const MessageSource> Open() {
    log_.Close();
    return OpenTranslatedLog(folder_ / "drive.mcap", {});
  }

  /// The only message of a log.
  RawMessage Only() {
    source_ = Open();
    EXPECT_EQ(source_->topics().size(), 1U);
    return source_->Read({true})->Next().value();
  }

  std::filesystem::path folder_ = MakeSchemaFolder();
  FoxgloveLog log_{folder_ / "drive.mcap", GetParam()};
  std::shared_ptr<const MessageSource> source_;
};

TEST_P(TranslatedSourceTest, ACompressedImageKeepsItsBytes) {
  log_.Add("/cam", "CompressedImage", kTime,
           {{"frame_id", "camera"}, {"format", "jpeg"}, {"data", "/9j/AAE="}});
  const RawMessage message = Only();
  const std::string& type = source_->topics()[0].type;

  const CompressedImageMessage image =
      DecodeCompressedImage(message.data, MessageEncoding::kCdr, type);

  EXPECT_EQ(type, "sensor_msgs/CompressedImage");
  EXPECT_EQ(source_->topics()[0].native_type, "foxglove.CompressedImage");
  EXPECT_EQ(image.header.stamp, kTime);
  EXPECT_EQ(image.header.frame_id, "camera");
  EXPECT_EQ(image.format, "jpeg");
  EXPECT_EQ(std::vector(image.data.begin(), image.data.end()),
            (std::vector<std::uint8_t>{0xff, 0xd8, 0xff, 0, 1}));
}

TEST_P(TranslatedSourceTest, AMessageIsReadAtItsPlaceAsInAPass) {
  log_.Add("/cam", "CompressedVideo", kTime, {{"format", "h264"}, {"data", "AAAAAQ=="}});
  const RawMessage message = Only();

  const std::optional<RawMessage> again = source_->ReadAt(0, message.place);

  ASSERT_TRUE(again);
  EXPECT_EQ(again->data, message.data);
}

TEST_P(TranslatedSourceTest, ARawImageKeepsItsForm) {
  log_.Add("/cam", "RawImage", kTime,
           {{"width", 2}, {"height", 1}, {"step", 2}, {"encoding", "mono8"}, {"data", "BQY="}});

  const RawMessage message = Only();
  const ImageMessage image = DecodeImage(message.data, MessageEncoding::kCdr);

  EXPECT_EQ(image.width, 2U);
  EXPECT_EQ(image.height, 1U);
  EXPECT_EQ(image.step, 2U);
  EXPECT_EQ(image.encoding, "mono8");
  EXPECT_EQ(std::vector(image.data.begin(), image.data.end()), (std::vector<std::uint8_t>{5, 6}));
}

TEST_P(TranslatedSourceTest, AFixHasItsPlaceAndUncertainty) {
  log_.Add("/gps", "LocationFix", kTime,
           {{"latitude", 48.1},
            {"longitude", 11.5},
            {"altitude", 512.25},
            {"position_covariance", {4, 0, 0, 0, 9, 0, 0, 0, 16}},
            {"position_covariance_type", 2}});

  const RawMessage message = Only();
  SensorStream stream;
  stream.encoding = MessageEncoding::kCdr;
  stream.type = source_->topics()[0].type;
  const std::optional<GnssFix> fix = ReadGnssFix(message, stream);

  ASSERT_TRUE(fix);
  EXPECT_EQ(fix->time, kTime);
  EXPECT_DOUBLE_EQ(fix->latitude_deg, 48.1);
  EXPECT_DOUBLE_EQ(fix->longitude_deg, 11.5);
  EXPECT_DOUBLE_EQ(fix->altitude, 512.25);
  EXPECT_EQ(fix->sigma_enu, Eigen::Vector3d(2, 3, 4));
}

TEST_P(TranslatedSourceTest, CalibrationAndTransformsMakeARig) {
  const int imu = log_.writer().AddChannel("/imu", "sensor_msgs/msg/Imu", "", "cdr");
  for (int i = 0; i < 200; ++i) {
    const Timestamp time = kTime + 0.01 * i;
    log_.writer().Write(imu, time, ImuBytes(MessageWriter(MessageEncoding::kCdr), time.ns));
  }
  log_.Add("/front/image", "RawImage", kTime, {{"frame_id", "camera"}});
  log_.Add("/front/calibration", "CameraCalibration", kTime,
           {{"width", 64},
            {"height", 48},
            {"distortion_model", "plumb_bob"},
            {"D", {-0.1, 0.01, 0.001, 0.002, 0}},
            {"K", {40, 0, 31.5, 0, 41, 23.5, 0, 0, 1}}});
  const json turned = {{"x", 0}, {"y", 0}, {"z", 1}, {"w", 0}};
  log_.Add("/tf", "FrameTransform", kTime,
           {{"parent_frame_id", "base_link"},
            {"child_frame_id", "imu"},
            {"translation", {{"x", 1}, {"z", 0.5}}},
            {"rotation", {{"w", 1}}}});
  log_.Add("/mounts", "FrameTransforms", kTime,
           {{"transforms",
             {{{"parent_frame_id", "imu"},
               {"child_frame_id", "camera"},
               {"translation", {{"y", 0.25}}},
               {"rotation", turned}}}}});

  const Rig rig = DiscoverRig(*Open());

  ASSERT_EQ(rig.cameras.size(), 1U);
  EXPECT_EQ(rig.cameras[0].model.width(), 64);
  EXPECT_EQ(rig.cameras[0].topic, "/front/image");
  EXPECT_TRUE(rig.vehicle);
  EXPECT_TRUE(rig.body_from_imu.translation.isApprox(Eigen::Vector3d(1, 0, 0.5)));
  EXPECT_TRUE(rig.cameras[0].body_from_camera.translation.isApprox(Eigen::Vector3d(1, 0.25, 0.5)));
  EXPECT_NEAR(rig.cameras[0].body_from_camera.rotation.z(), 1, 1e-12);
}

TEST_P(TranslatedSourceTest, OtherTypesKeepTheirNames) {
  log_.Add("/car", "CarState", kTime, {{"ticks_left", 5}});

  source_ = Open();

  EXPECT_EQ(source_->topics()[0].type,
            std::string("foxglove.CarState") +
                (GetParam() == std::string("json") ? " (JSON)" : " (protobuf)"));
}

INSTANTIATE_TEST_SUITE_P(Encodings, TranslatedSourceTest, testing::Values("protobuf", "json"),
                         [](const auto& info) { return std::string(info.param); });

/// A log with one message of foxglove_msgs in ROS 2; without its definition where that is empty.
RawMessage OnlyOfRos2(const std::string& type, const std::string& definition,
                      const std::vector<std::uint8_t>& data, TopicInfo& topic) {
  const std::filesystem::path folder = MakeSchemaFolder();
  McapWriter log(folder / "drive.mcap", "ros2");
  log.Write(log.AddChannel("/topic", "foxglove_msgs/msg/" + type, definition, "cdr"), kTime, data);
  log.Close();
  const auto source = OpenTranslatedLog(folder / "drive.mcap", {});
  topic = source->topics().at(0);
  RawMessage message = source->Read({true})->Next().value();
  std::filesystem::remove_all(folder);
  return message;
}

TEST(TranslateSourceTest, FoxglovesTypesAreReadAsRosMessages) {
  TopicInfo topic;
  MessageWriter image(MessageEncoding::kCdr);
  image.Header(kTime.ns, "camera").Bytes({0xff, 0xd8, 0xff}).Text("jpeg");
  const RawMessage jpeg = OnlyOfRos2("CompressedImage", "", image.Take(), topic);
  const CompressedImageMessage decoded =
      DecodeCompressedImage(jpeg.data, MessageEncoding::kCdr, topic.type);

  EXPECT_EQ(topic.type, "sensor_msgs/CompressedImage");
  EXPECT_EQ(topic.native_type, "foxglove_msgs/CompressedImage");
  EXPECT_EQ(decoded.header.stamp, kTime);
  EXPECT_EQ(decoded.header.frame_id, "camera");
  EXPECT_EQ(decoded.format, "jpeg");
  EXPECT_EQ(std::vector(decoded.data.begin(), decoded.data.end()),
            (std::vector<std::uint8_t>{0xff, 0xd8, 0xff}));

  MessageWriter fix(MessageEncoding::kCdr);
  fix.Header(kTime.ns, "gps").Doubles({48.1, 11.5, 512, 4, 0, 0, 0, 9, 0, 0, 0, 16});
  const RawMessage place = OnlyOfRos2("LocationFix", "", fix.Put(std::uint8_t{2}).Take(), topic);
  const NavSatMessage at = DecodeNavSat(place.data, MessageEncoding::kCdr);

  EXPECT_EQ(topic.type, "sensor_msgs/NavSatFix");
  EXPECT_EQ(at.latitude_deg, 48.1);
  EXPECT_EQ(at.covariance[4], 9);
  EXPECT_EQ(at.covariance_type, 2);
}

TEST(TranslateSourceTest, Ros2SpellsCalibrationsInSmallLetters) {
  TopicInfo topic;
  MessageWriter writer(MessageEncoding::kCdr);
  writer.Header(kTime.ns, "camera").Put(std::uint32_t{64}).Put(std::uint32_t{48});
  writer.Text("plumb_bob").Put(std::uint32_t{2}).Doubles({-0.1, 0.01});
  writer.Doubles({40, 0, 31.5, 0, 41, 23.5, 0, 0, 1});
  const RawMessage message =
      OnlyOfRos2("CameraCalibration",
                 "builtin_interfaces/Time timestamp\nstring frame_id\nuint32 width\nuint32 height\n"
                 "string distortion_model\nfloat64[] d\nfloat64[9] k\n",
                 writer.Take(), topic);
  const CameraInfoMessage info = DecodeCameraInfo(message.data, MessageEncoding::kCdr);

  EXPECT_EQ(topic.type, "sensor_msgs/CameraInfo");
  EXPECT_EQ(info.width, 64U);
  EXPECT_EQ(info.distortion, (std::vector<double>{-0.1, 0.01}));
  EXPECT_EQ(info.intrinsic_matrix[4], 41);
}

// Deep trees would be copied and read by recursion until the stack ends.
TEST(TranslateSourceTest, WhatIsNestedTooDeeplyIsRefused) {
  const std::filesystem::path folder = MakeSchemaFolder();
  McapWriter writer(folder / "drive.mcap", "", {});
  const std::string deep(200'000, '[');
  const int tf = writer.AddChannel("/tf", "foxglove.FrameTransform", "", "json");
  writer.Write(tf, kTime, std::vector<std::uint8_t>(deep.begin(), deep.end()));
  std::string idl = "module foxglove_msgs { module msg { struct FrameTransform { ";
  for (int i = 0; i < 25'000; ++i) idl += "sequence<";
  const int other = writer.AddChannel("/cam", "foxglove_msgs/msg/FrameTransform", idl, "cdr");
  writer.Write(other, kTime + 1, std::vector<std::uint8_t>(8));
  writer.Close();

  const auto source = OpenTranslatedLog(folder / "drive.mcap", {});
  const auto stream = source->Read(std::vector<bool>(source->topics().size(), true));
  while (stream->Next()) {
  }
  std::filesystem::remove_all(folder);
}

TEST(TranslateSourceTest, ADamagedMessageOrSchemaIsToldApart) {
  const std::filesystem::path folder = MakeSchemaFolder();
  FoxgloveLog log(folder / "drive.mcap", "protobuf");
  log.Add("/gps", "LocationFix", kTime, {{"latitude", 48.1}});
  const std::vector<std::uint8_t> damage(10, 0xff);
  log.writer().Write(0, kTime + 1, damage);
  const int other = log.writer().AddChannel("/cam", "foxglove.RawImage", "\xff\xff", "protobuf");
  log.writer().Write(other, kTime + 2, damage);
  log.Close();

  const auto source = OpenTranslatedLog(folder / "drive.mcap", {});
  const auto stream = source->Read({true, true});

  EXPECT_NO_THROW(DecodeNavSat(stream->Next()->data, MessageEncoding::kCdr));
  EXPECT_THROW(DecodeNavSat(stream->Next()->data, MessageEncoding::kCdr), Error);
  EXPECT_EQ(source->topics()[1].type, "foxglove.RawImage (protobuf)");
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace parkade
