#include "server/ingest/inspection/inspect_log.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/error.h"
#include "server/ingest/writing/mcap_writer.h"
#include "tests/server/ingest/drive/euroc_folder.h"
#include "tests/server/ingest/messages/message_writer.h"
#include "tests/support/api_description.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

const TopicInspection& Topic(const LogInspection& inspection, const std::string& name) {
  for (const TopicInspection& topic : inspection.topics)
    if (topic.topic == name) return topic;
  throw std::out_of_range(name);
}

std::string Replaced(const fs::path& file, const std::string& from, const std::string& to) {
  std::ifstream stream(file);
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(InspectLog, ACleanDriveIsTold) {
  const TestFolder folder;
  WriteEurocFolder(folder.path() / "mav0", {.has_wheels = true, .has_gnss = true});

  const LogInspection inspection = InspectLog(folder.path());

  EXPECT_EQ(inspection.ExitStatus(), 0);
  EXPECT_EQ(inspection.topics.size(), 5u);
  EXPECT_NEAR(Topic(inspection, "imu0").RateHz(), 100, 1e-6);
  EXPECT_EQ(Topic(inspection, "cam1").num_messages, 21u);
  EXPECT_EQ(Topic(inspection, "cam1").width, 64);
  EXPECT_TRUE(inspection.missing.empty());
  ASSERT_TRUE(inspection.rig.has_value());
  EXPECT_EQ(inspection.rig->cameras.size(), 2u);
  const std::string text = InspectionToText(inspection);
  EXPECT_NE(text.find("state: clean"), std::string::npos) << text;
  const nlohmann::json json = InspectionToJson(inspection);
  EXPECT_EQ(json["state"], "clean");
  EXPECT_EQ(json["topics"][0]["topic"], "imu0");
  EXPECT_EQ(json["begin"], "1000.000000000");
  EXPECT_EQ(json["rig"]["cameras"].size(), 2u);
  EXPECT_EQ(MismatchWith("Inspection", json), "");
}

TEST(InspectLog, DamageIsCountedPerTopicAndMakesTheLogLossy) {
  const TestFolder folder;
  const fs::path mav0 = folder.path() / "mav0";
  WriteEurocFolder(mav0);
  WriteText(mav0 / "cam1" / "data" / "1000307000000.png", "no image");
  fs::remove(mav0 / "cam1" / "data" / "1000407000000.png");
  WriteText(mav0 / "imu0" / "data.csv",
            Replaced(mav0 / "imu0" / "data.csv", "1000500000000,0.01", "1000500000000,inf"));

  const LogInspection inspection = InspectLog(folder.path());

  EXPECT_EQ(inspection.ExitStatus(), 3);
  EXPECT_EQ(Topic(inspection, "cam1").num_undecodable, 2u);
  EXPECT_EQ(Topic(inspection, "cam0").num_undecodable, 0u);
  EXPECT_EQ(Topic(inspection, "imu0").num_implausible, 1u);
  const std::string text = InspectionToText(inspection);
  EXPECT_NE(text.find("cam1: 2 damaged; first: neither JPEG nor PNG at 1000.307000000"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("state: lossy"), std::string::npos);
  EXPECT_EQ(MismatchWith("Inspection", InspectionToJson(inspection)), "");
}

TEST(InspectLog, GapsJumpsAndRepetitionsAreTold) {
  const TestFolder folder;
  const fs::path csv = folder.path() / "mav0" / "imu0" / "data.csv";
  WriteEurocFolder(folder.path() / "mav0", {.num_cameras = 1});
  std::ifstream stream(csv);
  std::string line, text;
  while (std::getline(stream, line)) {
    // Nothing from 0.5 s to 0.9 s, one sample twice.
    if (line.substr(0, 5) == "10005" || line.substr(0, 5) == "10006" ||
        line.substr(0, 5) == "10007" || line.substr(0, 5) == "10008")
      continue;
    text += line + "\n";
    if (line.starts_with("1001200000000")) text += line + "\n" + "999" + line.substr(4) + "\n";
  }
  stream.close();
  WriteText(csv, text);

  const TopicInspection imu = Topic(InspectLog(folder.path()), "imu0");

  ASSERT_EQ(imu.gaps.size(), 1u);
  EXPECT_NEAR(imu.gaps[0].seconds, 0.41, 1e-6);
  EXPECT_EQ(imu.gaps[0].begin.ns, 1'000'490'000'000);
  EXPECT_EQ(imu.num_repeated, 1u);
  EXPECT_EQ(imu.num_backward, 1u);
  EXPECT_NEAR(imu.largest_backward_jump, 2, 1e-6);
}

TEST(InspectLog, WhatIsMissingForAMapIsSaidAndNoFaultOfTheLog) {
  const TestFolder folder;
  const fs::path mav0 = folder.path() / "mav0";
  WriteEurocFolder(mav0, {.num_cameras = 1});
  fs::remove(mav0 / "cam0" / "sensor.yaml");

  const LogInspection inspection = InspectLog(folder.path());

  EXPECT_EQ(inspection.ExitStatus(), 0);
  EXPECT_EQ(inspection.missing, std::vector<std::string>{"no rig: cam0/sensor.yaml is missing"});
}

TEST(InspectLog, MasksAreNoDarkImagesHoweverTheyArePacked) {
  const TestFolder folder;
  const fs::path file = folder.path() / "drive.mcap";
  std::vector<std::uint8_t> black;
  cv::imencode(".png", cv::Mat::zeros(64, 96, CV_8UC1), black);
  McapWriter writer(file, "ros2");
  for (const std::string topic : {"/cam0/compressed", "/cam0/semantic/compressed"}) {
    const int channel = writer.AddChannel(topic, "sensor_msgs/msg/CompressedImage", "", "cdr");
    for (std::int64_t i = 0; i < 60; ++i) {
      const std::int64_t stamp = 1'700'000'000'000'000'000 + i * 100'000'000;
      writer.Write(
          channel, Timestamp{stamp},
          CompressedImageBytes(MessageWriter(MessageEncoding::kCdr), stamp, "cam0", black));
    }
  }
  writer.Close();

  const std::string text = InspectionToText(InspectLog(file));

  EXPECT_NE(text.find("/cam0/compressed: dark"), std::string::npos) << text;
  EXPECT_EQ(text.find("semantic/compressed: "), std::string::npos) << text;
}

TEST(InspectLog, WithoutImuOrImagesTheLogIsUnusable) {
  const TestFolder folder;
  WriteEurocFolder(folder.path() / "a" / "mav0");
  WriteEurocFolder(folder.path() / "b" / "mav0");
  fs::remove_all(folder.path() / "a" / "mav0" / "imu0");
  fs::remove_all(folder.path() / "b" / "mav0" / "cam0");
  fs::remove_all(folder.path() / "b" / "mav0" / "cam1");

  EXPECT_EQ(InspectLog(folder.path() / "a").ExitStatus(), 1);
  EXPECT_EQ(InspectLog(folder.path() / "b").ExitStatus(), 1);
}

/// A drive of half a minute whose accelerations are in g.
void WriteDriveInG(const fs::path& mav0) {
  WriteEurocFolder(mav0, {.seconds = 30, .num_cameras = 1});
  std::string imu = "#timestamp [ns]\n";
  for (std::int64_t i = 0; i <= 3000; ++i)
    imu += std::to_string(1'000'000'000'000 + i * 10'000'000) + ",0,0.01,0.02," +
           (i % 2 == 0 ? "0,0.01,1.01" : "0.01,0,0.99") + "\n";
  WriteText(mav0 / "imu0" / "data.csv", imu);
}

TEST(InspectLog, WhatMakesALogUnusableIsAFindingAlsoWithItsOwnRig) {
  const TestFolder folder;
  WriteDriveInG(folder.path() / "mav0");

  const LogInspection inspection = InspectLog(folder.path());

  EXPECT_EQ(inspection.ExitStatus(), 1);
  ASSERT_EQ(inspection.findings.size(), 1u);
  EXPECT_EQ(inspection.findings[0].name, "imu_in_g");
  EXPECT_EQ(inspection.missing, std::vector<std::string>{ToText(inspection.findings[0])});
  EXPECT_FALSE(inspection.is_of_beginning);
  EXPECT_EQ(Topic(inspection, "imu0").num_messages, 3001u);
}

TEST(InspectLog, OfALargeLogThatIsUnusableOnlyTheBeginningIsRead) {
  const TestFolder folder;
  WriteDriveInG(folder.path() / "mav0");

  const LogInspection inspection = InspectLog(folder.path(), {}, {}, /*large_log=*/0);

  EXPECT_EQ(inspection.ExitStatus(), 1);
  EXPECT_EQ(inspection.findings[0].name, "imu_in_g");
  EXPECT_TRUE(inspection.is_of_beginning);
  EXPECT_EQ(Topic(inspection, "imu0").num_messages, 2002u);
  EXPECT_NE(InspectionToText(inspection).find("state: unusable, only the beginning was read\n"),
            std::string::npos);
}

TEST(InspectLog, OfALargeLogWithoutImuOrSoundImagesOnlyTheBeginningIsRead) {
  const TestFolder folder;
  WriteEurocFolder(folder.path() / "a" / "mav0", {.seconds = 30, .num_cameras = 1});
  WriteEurocFolder(folder.path() / "b" / "mav0", {.seconds = 30, .num_cameras = 1});
  fs::remove_all(folder.path() / "a" / "mav0" / "imu0");
  for (const auto& image : fs::directory_iterator(folder.path() / "b" / "mav0" / "cam0" / "data"))
    WriteText(image.path(), "no image");

  for (const char* log : {"a", "b"}) {
    const LogInspection inspection = InspectLog(folder.path() / log, {}, {}, /*large_log=*/0);

    EXPECT_EQ(inspection.ExitStatus(), 1) << log;
    EXPECT_TRUE(inspection.is_of_beginning) << log;
    EXPECT_FALSE(inspection.missing.empty()) << log;
  }
}

TEST(InspectLog, ALargeLogThatCanBeUsedIsReadToItsEnd) {
  const TestFolder folder;
  WriteEurocFolder(folder.path() / "mav0", {.seconds = 30});

  const LogInspection large = InspectLog(folder.path(), {}, {}, /*large_log=*/0);

  EXPECT_FALSE(large.is_of_beginning);
  EXPECT_EQ(InspectionToText(large), InspectionToText(InspectLog(folder.path())));
  EXPECT_EQ(Topic(large, "imu0").num_messages, 3001u);
}

TEST(InspectLog, WhatIsNoLogIsRefusedWithOneSentence) {
  const TestFolder folder;
  WriteText(folder.path() / "empty.bag", "");
  WriteText(folder.path() / "letter.bag", "Dear Sir or Madam,");
  const auto refusal = [&](const std::string& name) -> std::string {
    try {
      InspectLog(folder.path() / name);
    } catch (const Error& error) {
      return error.what();
    }
    return "nothing";
  };

  EXPECT_EQ(refusal("empty.bag"), "empty.bag is empty");
  EXPECT_NE(refusal("letter.bag").find("letter.bag"), std::string::npos);
  EXPECT_EQ(refusal("nowhere.bag"), "there is no log nowhere.bag");
}

TEST(InspectLog, RealClipsAreReadToTheirEnds) {
  if (!fs::exists(SharedData() / "euroc_v101_clip"))
    GTEST_SKIP() << "PARKADE_SHARED_DATA has no euroc_v101_clip";
  // The index of cam1 names four files that are not there.
  EXPECT_EQ(InspectLog(SharedData() / "euroc_v101_clip").ExitStatus(), 3);
  EXPECT_EQ(
      InspectLog(SharedData() / "kitti_06_clip", SharedData() / "kitti_06_clip/rig").ExitStatus(),
      0);
}

}  // namespace
}  // namespace parkade
