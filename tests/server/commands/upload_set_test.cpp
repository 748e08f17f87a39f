#include <array>
#include <cstring>
#include <thread>

#include "core/files/file.h"
#include "server/ingest/files/archive_paths.h"
#include "server/ingest/files/sniff_log.h"
#include "server/ingest/inspection/inspect_log.h"
#include "server/store/tables/drive_table.h"
#include "server/store/uploads/resumable_uploads.h"
#include "server/store/uploads/upload_sets.h"
#include "tests/server/store/temporary_store.h"
#include "tests/support/rosbag1_writer.h"

namespace parkade {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

constexpr std::int64_t kNsPerSample = 10'000'000;

/// sensor_msgs/Imu of ROS 1, without a frame.
std::vector<std::uint8_t> ImuMessage(std::int64_t ns) {
  const std::array<std::uint32_t, 4> header = {0, static_cast<std::uint32_t>(ns / 1'000'000'000),
                                               static_cast<std::uint32_t>(ns % 1'000'000'000), 0};
  std::array<double, 37> values{};
  values[27] = 9.81;  // the acceleration's z
  std::vector<std::uint8_t> bytes(sizeof header + sizeof values);
  std::memcpy(bytes.data(), header.data(), sizeof header);
  std::memcpy(bytes.data() + sizeof header, values.data(), sizeof values);
  return bytes;
}

/// Samples [first, last) of an IMU at 100 Hz.
std::string BagOf(const fs::path& file, int first, int last) {
  Rosbag1Writer writer(file);
  const int channel = writer.AddChannel("/imu", "sensor_msgs/Imu", "", "*");
  for (int i = first; i < last; ++i) {
    const std::int64_t ns = 1'000'000'000'000 + i * kNsPerSample;
    writer.Write(channel, Timestamp{ns}, ImuMessage(ns));
  }
  writer.Close();
  return ReadFile(file);
}

/// Sets as the real service takes them in.
class UploadedSets : public StoreTest {
 protected:
  UploadOptions Options() const {
    UploadOptions options;
    options.check_log = [](const fs::path& file, const std::string&) { CheckLooksLikeLog(file); };
    options.check_paths = [](const std::vector<std::string>& paths) {
      CheckHoldsDrive(paths, "the set");
    };
    options.on_received = [](const ReceivedDrive&) {};
    return options;
  }
  void Send(const Upload& part, const std::string& content) {
    uploads_.Append(
        part.id, 0, std::ssize(content),
        [&](const auto& take) {
          take(content);
          return true;
        },
        std::nullopt, [] {});
  }

  ResumableUploads uploads_{store_, Options()};
};

TEST_F(UploadedSets, OfTwoSplitBagsAreInspectedAsOneDrive) {
  const std::string first = BagOf(root_.path() / "a.bag", 0, 150),
                    second = BagOf(root_.path() / "b.bag", 150, 400);
  const auto [set, parts] = uploads_.sets().Create(
      {}, {{"drive_1.bag", std::ssize(second), {}}, {"drive_0.bag", std::ssize(first), {}}});
  Send(parts[1], second);
  Send(parts[0], first);
  const auto drive = [&, &set = set] { return uploads_.sets().Look(set.id).set.drive; };
  for (int i = 0; i < 1000 && !drive(); ++i) std::this_thread::sleep_for(10ms);
  ASSERT_TRUE(drive().has_value());
  const std::string id = *drive();
  const std::string sha256 =
      store_.database.Read([&](Connection& connection) { return FindDrive(connection, id); })
          .sha256;

  const LogInspection inspection = InspectLog(store_.directory.LogFile(sha256));

  EXPECT_EQ(inspection.format, "ROS 1 bag");
  EXPECT_TRUE(inspection.damage.IsClean());
  ASSERT_EQ(inspection.topics.size(), 1u);
  EXPECT_EQ(inspection.topics[0].topic, "/imu");
  EXPECT_EQ(inspection.topics[0].num_messages, 400u);
  EXPECT_EQ(inspection.topics[0].num_undecodable, 0u);
  EXPECT_NEAR(inspection.topics[0].RateHz(), 100, 1e-6);
  EXPECT_TRUE(inspection.topics[0].gaps.empty());
}

TEST_F(UploadedSets, ThatWouldBeNoDriveAreRefusedBeforehand) {
  try {
    uploads_.sets().Create({}, {{"a/x.bag", 9, {}}, {"b/y.bag", 9, {}}});
    FAIL() << "two drives were taken for one";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "the set holds log files in several folders: give one of them");
  }
}

}  // namespace
}  // namespace parkade
