#include "server/ingest/schemas/mapped_source.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "server/ingest/drive/open_drive_log.h"
#include "server/ingest/inspection/inspect_log.h"
#include "server/ingest/messages/sensor_decoding.h"
#include "server/ingest/schemas/translated_source.h"
#include "tests/server/ingest/messages/message_writer.h"
#include "tests/server/ingest/schemas/foxglove_log.h"
#include "tests/support/rosbag1_writer.h"

namespace parkade {
namespace {

constexpr Timestamp kStart{1'700'000'000'000'000'000};

constexpr const char* kJointState =
    "std_msgs/Header header\n# of all joints\nstring[] name\nfloat64[] position\n"
    "float64[] velocity\nfloat64[] effort\n";
constexpr const char* kOwnImu =
    "uint8 KIND=3\nuint32 count\nfloat32[3] gyro\nAcceleration a\nint16[<=4] raw # spare\n"
    "================\nMSG: car_msgs/Acceleration\nint16 x\nint16 y\nint16 z\n";

class MappedSourceTest : public testing::Test {
 protected:
  ~MappedSourceTest() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path file() const { return folder_ / "drive.mcap"; }

  std::shared_ptr<const MessageSource> Open(const FieldMap& fields, double track = 0,
                                            double wheelbase = 0) {
    Rig rig;
    rig.vehicle = VehicleCalibration{};
    rig.vehicle->fields = fields;
    rig.vehicle->track = track;
    rig.vehicle->wheelbase = wheelbase;
    return MapFields(OpenTranslatedLog(file(), {}), rig);
  }

  /// What is said about a field map that does not fit.
  std::string Refusal(const FieldMap& fields, double track = 0) {
    try {
      Open(fields, track);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  static std::vector<RawMessage> Messages(const MessageSource& source) {
    std::vector<bool> wanted(source.topics().size(), false);
    wanted.back() = true;
    const auto stream = source.Read(wanted);
    std::vector<RawMessage> messages;
    while (auto message = stream->Next()) messages.push_back(*message);
    return messages;
  }

  static std::vector<WheelSample> Wheels(const MessageSource& source) {
    SensorStream stream;
    stream.encoding = source.topics().back().encoding;
    stream.type = source.topics().back().type;
    WheelReader reader;
    std::vector<WheelSample> samples;
    for (const RawMessage& message : Messages(source))
      samples.push_back(reader.Read(message, stream).value());
    return samples;
  }

  std::filesystem::path folder_ = MakeSchemaFolder();
};

std::vector<std::uint8_t> JointStateBytes(MessageEncoding encoding, Timestamp time,
                                          double speed_left, double speed_right) {
  MessageWriter writer(encoding);
  writer.Header(time.ns, "").Put(std::uint32_t{3});
  writer.Text("steering").Text("rear_left").Text("rear_right");
  writer.Put(std::uint32_t{0}).Put(std::uint32_t{3}).Doubles({9, speed_left, speed_right});
  return writer.Put(std::uint32_t{0}).Take();
}

FieldMap JointMap() {
  FieldMap fields;
  fields.wheels["speed_left"] = {"/joint_states", "velocity[name=rear_left]", 0.3};
  fields.wheels["speed_right"] = {"joint_states", "velocity[name=rear_right]", 0.3};
  return fields;
}

/// Wheels of radius 0.3 m at 10 and 11 rad/s, 1.5 m apart.
void ExpectJointSpeeds(const std::vector<WheelSample>& wheels) {
  ASSERT_EQ(wheels.size(), 1U);
  EXPECT_EQ(wheels[0].time, kStart + 0.5);
  EXPECT_NEAR(wheels[0].forward_speed, 3.15, 1e-12);
  EXPECT_NEAR(wheels[0].yaw_rate, 0.2, 1e-12);
}

TEST_F(MappedSourceTest, JointsOfRos2AreWheelsByTheirNames) {
  McapWriter log(file(), "ros2");
  const int joints =
      log.AddChannel("/joint_states", "sensor_msgs/msg/JointState", kJointState, "cdr");
  log.Write(joints, kStart, JointStateBytes(MessageEncoding::kCdr, kStart + 0.5, 10, 11));
  log.Close();

  ExpectJointSpeeds(Wheels(*Open(JointMap(), 1.5)));
}

TEST_F(MappedSourceTest, TypesThatTheLogOnlyNamesMayBeKnown) {
  McapWriter log(file(), "ros2");
  const int joints = log.AddChannel("/joint_states", "sensor_msgs/msg/JointState", "", "cdr");
  log.Write(joints, kStart, JointStateBytes(MessageEncoding::kCdr, kStart + 0.5, 10, 11));
  log.Close();

  ExpectJointSpeeds(Wheels(*Open(JointMap(), 1.5)));
}

TEST_F(MappedSourceTest, ABagDefinesItsMessages) {
  Rosbag1Writer log(file());
  const int joints = log.AddChannel("/joint_states", "sensor_msgs/JointState", kJointState, "*");
  log.Write(joints, kStart, JointStateBytes(MessageEncoding::kRos1, kStart + 0.5, 10, 11));
  log.Close();

  ExpectJointSpeeds(Wheels(*Open(JointMap(), 1.5)));
}

// As rosidl generates it.
constexpr const char* kJointStateIdl = R"idl(========================
IDL: sensor_msgs/msg/JointState
// generated from rosidl_adapter/resource/msg.idl.em
#include "std_msgs/msg/Header.idl"

module sensor_msgs {
  module msg {
    typedef double double__2[2];
    module JointState_Constants {
      const int8 KIND = 3;
    };
    @verbatim (language="comment", text=
      "States of joints (" "all of them)")
    struct JointState {
      std_msgs::msg::Header header;

      sequence<string> name;
      @unit (value="rad")
      sequence<double, 8> position;
      sequence<double> velocity;
      double__2 range;
      unsigned long long count;
      wstring<20> remark;
      sequence<double> effort;
    };
  };
};

========================
IDL: std_msgs/msg/Header
module std_msgs { module msg { /* as of ROS 2 */ struct Header {
  builtin_interfaces::msg::Time stamp; string frame_id; }; }; };
)idl";

TEST_F(MappedSourceTest, ADefinitionMayBeIdlAndATextWide) {
  for (const bool are_four_bytes : {true, false}) {
    McapWriter log(file(), "ros2");
    const int joints =
        log.AddChannel("/joint_states", "sensor_msgs/msg/JointState", kJointStateIdl, "cdr");
    MessageWriter writer(MessageEncoding::kCdr);
    writer.Header((kStart + 0.5).ns, "").Put(std::uint32_t{2});
    writer.Text("rear_left").Text("rear_right").Put(std::uint32_t{0}).Put(std::uint32_t{2});
    writer.Doubles({10, 11, -1, 1}).Put(std::uint64_t{7}).Put(std::uint32_t{3});
    for (const char16_t letter : {u'a', u'ß', u'c'}) {
      if (are_four_bytes)
        writer.Put(static_cast<std::uint32_t>(letter));
      else
        writer.Put(static_cast<std::uint16_t>(letter));
    }
    log.Write(joints, kStart, writer.Put(std::uint32_t{1}).Doubles({42}).Take());
    log.Close();
    FieldMap fields = JointMap();

    ExpectJointSpeeds(Wheels(*Open(fields, 1.5)));
    fields.wheels["speed_left"].path = "effort[0]";
    EXPECT_NEAR(Wheels(*Open(fields, 1.5)).at(0).forward_speed, 0.15 * (42 + 11), 1e-12);
    fields.wheels["speed_left"].path = "range[1]";
    EXPECT_NEAR(Wheels(*Open(fields, 1.5)).at(0).forward_speed, 0.15 * (1 + 11), 1e-12);
  }
}

TEST_F(MappedSourceTest, IdlThatCannotBeReadIsRefused) {
  const auto refusal = [&](const std::string& text) {
    McapWriter log(file(), "ros2");
    log.Write(log.AddChannel("/car", "car_msgs/msg/Own", text, "cdr"), kStart,
              std::vector<std::uint8_t>{0, 1, 0, 0});
    log.Close();
    FieldMap fields;
    fields.gnss["latitude"] = fields.gnss["longitude"] = {"/car", "x"};
    return Refusal(fields);
  };

  EXPECT_EQ(refusal("module car_msgs { module msg { union Own"),
            "the message definition in IDL holds 'union', which is not supported");
  EXPECT_EQ(refusal("module car_msgs { struct Own { double"),
            "the message definition in IDL ends too early");
  EXPECT_EQ(refusal("module car_msgs { struct Other { double x; }; };"),
            "the message definition in IDL does not define car_msgs/Own");
}

TEST_F(MappedSourceTest, ASteeredCarTurnsByItsWheelbase) {
  McapWriter log(file(), "ros2");
  const int drive = log.AddChannel("/drive", "ackermann_msgs/msg/AckermannDriveStamped", "", "cdr");
  MessageWriter writer(MessageEncoding::kCdr);
  writer.Header(kStart.ns, "").Put(0.5F).Put(0.0F).Put(4.0F).Put(0.0F).Put(0.0F);
  log.Write(drive, kStart, writer.Take());
  log.Close();
  FieldMap fields;
  fields.wheels["speed"] = {"/drive", "drive.speed"};
  fields.wheels["steering_angle"] = {"/drive", "drive.steering_angle", -1, 0.1};

  const std::vector<WheelSample> wheels = Wheels(*Open(fields, 0, 2.5));

  ASSERT_EQ(wheels.size(), 1U);
  EXPECT_DOUBLE_EQ(wheels[0].forward_speed, 4);
  EXPECT_NEAR(wheels[0].yaw_rate, 4 * std::tan(-0.4) / 2.5, 1e-7);
}

TEST_F(MappedSourceTest, AnImuOfTheMakersOwnTypeIsScaled) {
  McapWriter log(file(), "ros2");
  const int imu = log.AddChannel("/car/imu", "car_msgs/msg/Imu", kOwnImu, "cdr");
  MessageWriter writer(MessageEncoding::kCdr);
  writer.Put(std::uint32_t{7}).Put(1.0F).Put(2.0F).Put(-3.0F);
  writer.Put(std::int16_t{10}).Put(std::int16_t{-20}).Put(std::int16_t{981}).Put(std::uint32_t{0});
  log.Write(imu, kStart, writer.Take());
  log.Close();
  FieldMap fields;
  for (int i = 0; i < 3; ++i) {
    const std::string axis(1, static_cast<char>('x' + i));
    fields.imu["rate_" + axis] = {"/car/imu", "gyro[" + std::to_string(i) + "]", 0.5};
    fields.imu["acceleration_" + axis] = {"/car/imu", "a." + axis, 0.01};
  }

  const auto source = Open(fields);
  const std::vector<RawMessage> messages = Messages(*source);
  SensorStream stream;
  stream.encoding = MessageEncoding::kCdr;
  stream.type = "sensor_msgs/Imu";
  const ImuSample sample = ReadImuSample(messages.at(0), stream);

  EXPECT_EQ(source->topics().back().topic, kImuFields);
  EXPECT_EQ(source->topics().back().num_messages, 1U);
  EXPECT_EQ(sample.time, kStart);  // of the log: the message has none
  EXPECT_TRUE(sample.angular_velocity.isApprox(Eigen::Vector3d(0.5, 1, -1.5)));
  EXPECT_TRUE(sample.linear_acceleration.isApprox(Eigen::Vector3d(0.1, -0.2, 9.81)));
}

class MappedEncodingsTest : public MappedSourceTest,
                            public testing::WithParamInterface<const char*> {};

TEST_P(MappedEncodingsTest, TicksAreSpeedsMidwayBetweenMessages) {
  FoxgloveLog log(file(), GetParam());
  log.Add("/car", "CarState", kStart, {{"ticks_left", 1000}, {"ticks_right", 2000}});
  log.Add("/car", "CarState", kStart + 0.1, {{"ticks_left", 1010}, {"ticks_right", 2014}});
  log.Add("/car", "CarState", kStart + 0.2, {{"ticks_left", 0}, {"ticks_right", 0}});
  log.Add("/car", "CarState", kStart + 0.3, {{"ticks_left", -10}, {"ticks_right", -10}});
  log.Close();
  FieldMap fields;
  fields.wheels["ticks_left"] = {"/car", "ticks_left"};
  fields.wheels["ticks_right"] = {"/car", "ticks_right"};
  fields.meters_per_tick = 0.02;

  const std::vector<WheelSample> wheels = Wheels(*Open(fields, 1.6));

  ASSERT_EQ(wheels.size(), 2U);
  EXPECT_EQ(wheels[0].time, kStart + 0.05);
  EXPECT_NEAR(wheels[0].forward_speed, 2.4, 1e-6);
  EXPECT_NEAR(wheels[0].yaw_rate, 0.5, 1e-6);
  EXPECT_NEAR(wheels[1].forward_speed, -2, 1e-6);
}

TEST_P(MappedEncodingsTest, SignalsOfSeveralTopicsAreJoined) {
  FoxgloveLog log(file(), GetParam());
  log.Add("/turn", "CarState", kStart, {{"rates", {{"z", 20}}}});
  log.Add("/car", "CarState", kStart + 0.1,
          {{"wheels", {{{"name", "front"}, {"speed", 9}}, {{"name", "rear"}, {"speed", 36}}}}});
  log.Close();
  FieldMap fields;
  fields.wheels["speed"] = {"/car", "wheels[name=rear].speed", 1 / 3.6};
  fields.wheels["yaw_rate"] = {"/turn", "rates.z", 0.01};

  const std::vector<WheelSample> wheels = Wheels(*Open(fields));

  ASSERT_EQ(wheels.size(), 1U);
  EXPECT_EQ(wheels[0].time, kStart + 0.1);
  EXPECT_NEAR(wheels[0].forward_speed, 10, 1e-9);
  EXPECT_NEAR(wheels[0].yaw_rate, 0.2, 1e-9);
}

TEST_P(MappedEncodingsTest, AFixNeedsNoMoreThanAPlace) {
  FoxgloveLog log(file(), GetParam());
  log.Add("/car", "CarState", kStart, {{"can", {481000000, 115000000, 3}}});
  log.Close();
  FieldMap fields;
  fields.gnss["latitude"] = {"/car", "can[0]", 1e-7};
  fields.gnss["longitude"] = {"/car", "can[1]", 1e-7};
  fields.gnss["sigma_horizontal"] = {"/car", "can[2]"};

  const auto source = Open(fields);
  SensorStream stream;
  stream.encoding = MessageEncoding::kCdr;
  stream.type = "sensor_msgs/NavSatFix";
  const std::optional<GnssFix> fix = ReadGnssFix(Messages(*source).at(0), stream);

  ASSERT_TRUE(fix);
  EXPECT_NEAR(fix->latitude_deg, 48.1, 1e-9);
  EXPECT_NEAR(fix->longitude_deg, 11.5, 1e-9);
  EXPECT_EQ(fix->sigma_enu.head<2>(), Eigen::Vector2d(3, 3));
  EXPECT_EQ(fix->sigma_enu.z(), GnssFix::kUnknownAltitude);
}

TEST_P(MappedEncodingsTest, ADriveWithoutAnyRosMessageIsRead) {
  FoxgloveLog log(file(), GetParam());
  const nlohmann::json image = {{"width", 64},
                                {"height", 48},
                                {"encoding", "mono8"},
                                {"step", 64},
                                {"data", std::string(4096, 'A')}};
  for (int i = 0; i < 400; ++i) {
    const Timestamp time = kStart + 0.01 * i;
    log.Add("/car", "CarState", time,
            {{"rates", {{"x", 0.001}, {"y", 0}, {"z", i % 2 == 0 ? 0.002 : 0.001}}},
             {"can", {0.01, 0, 9.81}}});
    if (i % 10 == 0) log.Add("/front/image", "RawImage", time, image);
  }
  log.Close();
  Rig rig;
  RigCamera& camera = rig.cameras.emplace_back();
  camera.name = "cam0";
  camera.topic = "/front/image";
  camera.model = CameraModel(PinholeProjection{.fx = 40, .fy = 40, .cx = 31.5, .cy = 23.5}, 64, 48);
  rig.vehicle = VehicleCalibration{};
  for (int i = 0; i < 3; ++i) {
    const std::string axis(1, static_cast<char>('x' + i));
    rig.vehicle->fields.imu["rate_" + axis] = {"/car", "rates." + axis};
    rig.vehicle->fields.imu["acceleration_" + axis] = {"/car", "can[" + std::to_string(i) + "]"};
  }
  std::filesystem::create_directories(folder_ / "rig");
  WriteRig(rig, folder_ / "rig");

  const auto drive = OpenDriveLog(file(), {.rig_folder = folder_ / "rig"});

  EXPECT_EQ(drive->rig().imu.topic, kImuFields);
  EXPECT_NEAR(drive->span().Seconds(), 3.99, 1e-6);
  ASSERT_EQ(drive->health().streams.size(), 2U);
  EXPECT_EQ(drive->health().streams[0].num_delivered, 400U);
  EXPECT_EQ(drive->health().streams[1].num_delivered, 40U);
  const LogInspection inspection = InspectLog(file(), folder_ / "rig");
  EXPECT_NE(inspection.state, LogState::kUnusable) << InspectionToText(inspection);
  const TopicInspection& row = inspection.topics.back();
  EXPECT_EQ(row.topic, kImuFields);
  EXPECT_EQ(row.type, "sensor_msgs/Imu");
  EXPECT_EQ(row.num_messages, 400U);
  EXPECT_NEAR(row.RateHz(), 100, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Encodings, MappedEncodingsTest, testing::Values("protobuf", "json"),
                         [](const auto& info) { return std::string(info.param); });

TEST_F(MappedSourceTest, WhatIsMissingIsNamedWithWhatThereIs) {
  FoxgloveLog log(file(), "json");
  log.Add("/car", "CarState", kStart, {{"v", 1}, {"can", {1, 2, 3}}});
  log.Close();
  FieldMap fields;
  fields.wheels["speed"] = {"/car", "can[3]"};
  fields.wheels["yaw_rate"] = {"/car", "can[0]"};

  EXPECT_EQ(Refusal(fields),
            "the field map of vehicle.yaml wants 'speed' at 'can[3]' of /car, which has numbers at "
            "can[0..2], timestamp.nsec, timestamp.sec and v");
  fields.wheels["speed"].topic = "/bus";
  EXPECT_EQ(Refusal(fields),
            "the field map of vehicle.yaml names the topic /bus, which is not in the log: it has "
            "/car");
  fields.wheels["speed"] = {"/car", "can[x]"};
  EXPECT_EQ(Refusal(fields),
            "'can[x]' is no path into a message: write it as twist.linear.x, data[3] or "
            "velocity[name=rear_left]");
  fields.wheels.erase("yaw_rate");
  fields.wheels["speed"] = {"/car", "v"};
  fields.wheels["steering_angle"] = {"/car", "v"};
  EXPECT_EQ(Refusal(fields),
            "the field map of vehicle.yaml needs its 'wheelbase' for the yaw rate");
}

TEST_F(MappedSourceTest, AJointThatThereIsNotIsToldThoseThatThereAre) {
  McapWriter log(file(), "ros2");
  const int joints = log.AddChannel("/joint_states", "sensor_msgs/msg/JointState", "", "cdr");
  log.Write(joints, kStart, JointStateBytes(MessageEncoding::kCdr, kStart + 0.5, 10, 11));
  log.Close();
  FieldMap fields = JointMap();
  fields.wheels["speed_left"].path = "velocity[name=wheel_left]";

  EXPECT_EQ(Refusal(fields), "the field map of vehicle.yaml needs its 'track' for the yaw rate");
  EXPECT_EQ(Refusal(fields, 1.5),
            "the field map of vehicle.yaml wants 'speed_left' at 'velocity[name=wheel_left]' of "
            "/joint_states, which has the names rear_left, rear_right, steering");
}

TEST_F(MappedSourceTest, ATypeThatNobodyDefinesIsNamed) {
  McapWriter log(file(), "ros2");
  log.Write(log.AddChannel("/car", "car_msgs/msg/Own", "", "cdr"), kStart,
            std::vector<std::uint8_t>{0, 1, 0, 0});
  log.Close();
  FieldMap fields;
  fields.gnss["latitude"] = fields.gnss["longitude"] = {"/car", "x"};

  EXPECT_EQ(Refusal(fields), "the log does not define car_msgs/Own, the type of /car");
}

TEST_F(MappedSourceTest, ADefinitionThatContainsItselfEnds) {
  McapWriter log(file(), "ros2");
  log.Write(log.AddChannel("/car", "car_msgs/msg/Own", "Own own\n", "cdr"), kStart,
            std::vector<std::uint8_t>{0, 1, 0, 0});
  log.Close();
  FieldMap fields;
  fields.gnss["latitude"] = fields.gnss["longitude"] = {"/car", "own.x"};

  EXPECT_EQ(Refusal(fields),
            "the field map of vehicle.yaml wants 'latitude' at 'own.x' of /car, which has no "
            "message that can be read");
}

}  // namespace
}  // namespace parkade
