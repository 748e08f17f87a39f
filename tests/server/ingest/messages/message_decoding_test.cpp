#include "server/ingest/messages/message_decoding.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/error.h"
#include "server/ingest/messages/sensor_decoding.h"
#include "tests/server/ingest/messages/message_writer.h"

namespace parkade {
namespace {

constexpr std::int64_t kStamp = 1'700'000'000'123'456'789;

/// All that can carry a message: ROS 1, and CDR in both byte orders.
struct Case {
  MessageEncoding encoding;
  bool is_big_endian;
  MessageWriter Writer() const { return MessageWriter(encoding, is_big_endian); }
};

class EachEncoding : public testing::TestWithParam<Case> {
 protected:
  MessageWriter Writer() const { return GetParam().Writer(); }
  MessageEncoding encoding() const { return GetParam().encoding; }
};

INSTANTIATE_TEST_SUITE_P(Messages, EachEncoding,
                         testing::Values(Case{MessageEncoding::kRos1, false},
                                         Case{MessageEncoding::kCdr, false},
                                         Case{MessageEncoding::kCdr, true}),
                         [](const auto& info) {
                           return info.param.encoding == MessageEncoding::kRos1 ? "Ros1"
                                  : info.param.is_big_endian                    ? "CdrBigEndian"
                                                                                : "Cdr";
                         });

TEST_P(EachEncoding, ImuIsRead) {
  const ImuMessage imu = DecodeImu(ImuBytes(Writer(), kStamp, "imu_link"), encoding());

  EXPECT_EQ(imu.header.stamp.ns, kStamp);
  EXPECT_EQ(imu.header.frame_id, "imu_link");
  EXPECT_EQ(imu.angular_velocity, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(imu.linear_acceleration, Eigen::Vector3d(1, 2, 9.8));
}

TEST_P(EachEncoding, TheThreeWheelTypesAreRead) {
  const OdometryMessage odometry = DecodeOdometry(
      OdometryBytes(Writer(), kStamp, {.x = 3, .y = 4, .yaw = 0.5, .speed = 2, .yaw_rate = 0.1}),
      encoding(), "nav_msgs/Odometry");
  EXPECT_TRUE(odometry.has_pose);
  EXPECT_EQ(odometry.odom_from_child.translation, Eigen::Vector3d(3, 4, 0));
  EXPECT_NEAR(LogSo3(odometry.odom_from_child.rotation).z(), 0.5, 1e-12);
  EXPECT_EQ(odometry.linear.x(), 2);
  EXPECT_EQ(odometry.angular.z(), 0.1);

  for (const bool has_covariance : {false, true}) {
    const OdometryMessage twist = DecodeOdometry(
        TwistBytes(Writer(), kStamp, 1.5, -0.25, has_covariance), encoding(),
        has_covariance ? "geometry_msgs/TwistWithCovarianceStamped" : "geometry_msgs/TwistStamped");
    EXPECT_FALSE(twist.has_pose);
    EXPECT_EQ(twist.linear.x(), 1.5);
    EXPECT_EQ(twist.angular.z(), -0.25);
  }
}

TEST_P(EachEncoding, GnssIsReadWithItsCovarianceAndStatus) {
  const NavSatMessage fix = DecodeNavSat(NavSatBytes(Writer(), kStamp, 2, 4, 2), encoding());

  EXPECT_EQ(fix.status, 2);
  EXPECT_EQ(fix.latitude_deg, 48.1);
  EXPECT_EQ(fix.longitude_deg, 11.5);
  EXPECT_EQ(fix.altitude, 512.25);
  EXPECT_EQ(fix.covariance[4], 8);
  EXPECT_EQ(fix.covariance_type, 2);
}

TEST_P(EachEncoding, AFixIsDroppedWithoutStatusAndVagueWithoutCovariance) {
  SensorStream stream;
  stream.encoding = encoding();
  const auto read = [&](int status, double variance, int type) {
    return ReadGnssFix({0, {}, NavSatBytes(Writer(), kStamp, status, variance, type)}, stream);
  };

  EXPECT_FALSE(read(-1, 4, 2).has_value());
  EXPECT_TRUE(read(0, 4, 2)->sigma_enu.isApprox(Eigen::Vector3d(2, std::sqrt(8), std::sqrt(12))));
  EXPECT_GE(read(0, 4, 0)->sigma_enu.x(), 3);
  EXPECT_GE(read(0, 0, 2)->sigma_enu.x(), 3);
}

TEST_P(EachEncoding, CameraInfoIsRead) {
  const CameraInfoMessage info =
      DecodeCameraInfo(CameraInfoBytes(Writer(), kStamp, "cam"), encoding());

  EXPECT_EQ(info.width, 64u);
  EXPECT_EQ(info.height, 48u);
  EXPECT_EQ(info.distortion_model, "plumb_bob");
  EXPECT_EQ(info.distortion, (std::vector<double>{-0.1, 0.01, 0.001, 0.002, 0.003}));
  EXPECT_EQ(info.intrinsic_matrix[4], 41);
  EXPECT_EQ(info.projection_matrix[5], 43);
}

TEST_P(EachEncoding, TransformsAreRead) {
  const auto transforms = DecodeTransforms(
      TransformBytes(Writer(),
                     {{"base_link", "a", {1, 2, 3}}, {"a", "camera", {4, 5, 6}, {1, 0, 0, 0}}}),
      encoding());

  ASSERT_EQ(transforms.size(), 2u);
  EXPECT_EQ(transforms[0].header.frame_id, "base_link");
  EXPECT_EQ(transforms[1].child_frame_id, "camera");
  EXPECT_EQ(transforms[1].parent_from_child.translation, Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(transforms[1].parent_from_child.rotation.x(), 1);
}

TEST_P(EachEncoding, ImagesAreViewedInPlace) {
  const auto bytes =
      ImageBytes(Writer(), kStamp, "cam", {2, 3, 2, "mono8", false, {1, 2, 3, 4, 5, 6}});
  const ImageMessage image = DecodeImage(bytes, encoding());
  EXPECT_EQ(image.width, 2u);
  EXPECT_EQ(image.height, 3u);
  EXPECT_EQ(image.data.size(), 6u);
  EXPECT_EQ(image.data[5], 6);

  const auto compressed = CompressedImageBytes(Writer(), kStamp, "cam", {9, 8, 7});
  EXPECT_EQ(DecodeCompressedImage(compressed, encoding(), "sensor_msgs/CompressedImage").data[2],
            7);
}

TEST_P(EachEncoding, AZeroStampGivesWayToTheLogTime) {
  EXPECT_EQ(StampOf({0, Timestamp{77}, ImuBytes(Writer(), 0)}, encoding(), "sensor_msgs/Imu").ns,
            77);
  EXPECT_EQ(
      StampOf({0, Timestamp{77}, ImuBytes(Writer(), kStamp)}, encoding(), "sensor_msgs/Imu").ns,
      kStamp);
}

TEST_P(EachEncoding, SecondsAndNanosecondsInEachOthersPlaceAreReadAsTheyAreMeant) {
  constexpr std::ptrdiff_t kSeconds = 4, kNanoseconds = 8, kEnd = 12;  // in the bytes
  constexpr std::int64_t kToday = 1'796'000'000'123'456'789;
  std::vector<std::uint8_t> bytes = ImuBytes(Writer(), kToday);
  std::swap_ranges(bytes.begin() + kSeconds, bytes.begin() + kNanoseconds,
                   bytes.begin() + kNanoseconds);
  EXPECT_EQ(DecodeImu(bytes, encoding()).header.stamp.ns, kToday);
  // Fields that a driver did not carry over are a sum, and so is a simulator's time.
  std::fill(bytes.begin() + kSeconds, bytes.begin() + kEnd, std::uint8_t{0});
  const std::ptrdiff_t billion = encoding() == MessageEncoding::kCdr && GetParam().is_big_endian
                                     ? kNanoseconds
                                     : kNanoseconds + 3;
  bytes[static_cast<std::size_t>(billion)] = 0x40;  // 2^30 ns
  EXPECT_EQ(DecodeImu(bytes, encoding()).header.stamp.ns, std::int64_t{1} << 30);
}

TEST_P(EachEncoding, AMessageCutAnywhereIsRefused) {
  const auto expect_refused = [&](std::vector<std::uint8_t> bytes, std::size_t size,
                                  const auto& decode) {
    for (; size > 0; --size) {
      bytes.resize(size - 1);
      EXPECT_THROW(decode(bytes), Error) << size;
    }
  };

  // Fields behind the last one read (covariances, region of interest) may be missing.
  const auto imu = ImuBytes(Writer(), kStamp);
  expect_refused(imu, imu.size() - 9 * 8, [&](const auto& bytes) { DecodeImu(bytes, encoding()); });
  const auto image = ImageBytes(Writer(), kStamp, "c", {2, 1, 2, "mono8", false, {1, 2}});
  expect_refused(image, image.size(), [&](const auto& bytes) { DecodeImage(bytes, encoding()); });
  const auto transform = TransformBytes(Writer(), {{"a", "b"}});
  expect_refused(transform, transform.size(),
                 [&](const auto& bytes) { DecodeTransforms(bytes, encoding()); });
  const auto info = CameraInfoBytes(Writer(), kStamp, "c");
  expect_refused(info, info.size() - 6 * 4 - 1,
                 [&](const auto& bytes) { DecodeCameraInfo(bytes, encoding()); });
}

TEST_P(EachEncoding, NoLengthInAMessageIsBelieved) {
  std::mt19937 random(3);
  const std::vector<std::vector<std::uint8_t>> originals = {
      TransformBytes(Writer(), {{"a", "b"}, {"c", "d"}}), CameraInfoBytes(Writer(), kStamp, "c"),
      ImageBytes(Writer(), kStamp, "c", {2, 1, 2, "mono8", false, {1, 2}}),
      OdometryBytes(Writer(), kStamp, {})};
  for (int trial = 0; trial < 4000; ++trial) {
    auto bytes = originals[static_cast<std::size_t>(trial) % originals.size()];
    for (int i = 0; i < 4; ++i)
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random() % 3 ? 0xff : random());

    // Refused or read, but never beyond the message (the sanitizers' job) and never with gigabytes.
    try {
      switch (trial % 4) {
        case 0: EXPECT_LT(DecodeTransforms(bytes, encoding()).size(), 5u); break;
        case 1: EXPECT_LT(DecodeCameraInfo(bytes, encoding()).distortion.size(), 100u); break;
        case 2: EXPECT_LE(DecodeImage(bytes, encoding()).data.size(), bytes.size()); break;
        default: DecodeOdometry(bytes, encoding(), "nav_msgs/Odometry");
      }
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kInvalidInput);
    }
  }
}

TEST(CdrMessages, OtherRepresentationsAreRefused) {
  auto bytes = ImuBytes(MessageWriter(MessageEncoding::kCdr), kStamp);
  bytes[1] = 3;  // a parameter list

  EXPECT_THROW(DecodeImu(bytes, MessageEncoding::kCdr), Error);
}

TEST(WheelReader, DifferencesOfThePoseGiveTheSpeedOfAnArc) {
  // 2 m/s on a circle of 4 m radius: 0.5 rad/s.
  SensorStream stream;
  stream.type = "nav_msgs/Odometry";
  stream.is_speed_from_pose = true;
  WheelReader reader;
  std::optional<WheelSample> sample;
  for (int i = 0; i < 3; ++i) {
    const double yaw = 0.5 * 0.1 * i;
    const OdometryValues values{.x = 4 * std::sin(yaw), .y = 4 * (1 - std::cos(yaw)), .yaw = yaw};
    sample = reader.Read(
        {0, {}, OdometryBytes(MessageWriter(MessageEncoding::kRos1), i * 100'000'000 + 1, values)},
        stream);
  }

  ASSERT_TRUE(sample.has_value());
  EXPECT_NEAR(sample->forward_speed, 2, 1e-3);  // the chord is shorter than the arc
  EXPECT_NEAR(sample->yaw_rate, 0.5, 1e-6);
  EXPECT_EQ(sample->time.ns, 150'000'001);
}

}  // namespace
}  // namespace parkade
