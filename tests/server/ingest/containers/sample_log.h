#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "server/ingest/containers/raw_message.h"
#include "server/ingest/writing/mcap_writer.h"
#include "tests/support/rosbag1_writer.h"

namespace parkade {

// A small drive that this file, sample.mjs and sample.py know alike: four topics over four seconds,
// each message with a checksum of its own at its end, so that a test can tell a good message from a
// damaged one without a second copy.

struct SampleTopic {
  const char* topic;
  const char* type;
  int period;  ///< [tick] of 10 ms
  int begin;   ///< first tick
  std::size_t size;
};

inline constexpr std::array<SampleTopic, 4> kSampleTopics = {
    {{"/imu", "sensor_msgs/Imu", 1, 0, 320},
     {"/cam0/image_raw", "sensor_msgs/Image", 5, 0, 6000},
     {"/odom", "nav_msgs/Odometry", 2, 0, 700},
     {"/fix", "sensor_msgs/NavSatFix", 10, 100, 120}}};

struct SampleMessage {
  std::size_t topic = 0;
  Timestamp time;
  std::vector<std::uint8_t> data;
};

/// All 710 of them, in order of time.
const std::vector<SampleMessage>& SampleMessages();

/// Index into SampleMessages() of a message that was read, or nothing when a byte, the topic or the
/// time is wrong.
std::optional<std::size_t> FindSample(const std::string& topic, const RawMessage& message);

/// Where a chunk lies in a file and how many messages it holds.
struct SampleChunk {
  std::uint64_t begin = 0, end = 0;
  std::size_t num_messages = 0;
};

struct SampleFile {
  std::filesystem::path path;
  std::vector<SampleChunk> chunks;  ///< in the order of the file; empty for files without chunks
};

/// A sample written by an official writer: `script` of this folder with `arguments`, made once per
/// build and kept. Nothing when the script's program is not installed; the caller then skips.
std::optional<SampleFile> MakeSample(const std::string& script, const std::string& extension,
                                     const std::vector<std::string>& arguments);

/// A script of this folder on `arguments`: its standard output. Nothing when it failed.
std::optional<std::string> RunScript(const std::string& script,
                                     const std::vector<std::string>& arguments);

/// What a pass over a log gave.
struct ReadLog {
  std::vector<TopicInfo> topics;
  std::vector<std::size_t>
      found;  ///< indices into SampleMessages() of the good messages, in the order they came
  std::size_t num_wrong = 0;      ///< messages that are none of the sample
  std::size_t num_misplaced = 0;  ///< messages that MessageSource::ReadAt does not find again
  DamageReport damage;

  std::size_t NumFoundOf(std::size_t first,
                         std::size_t count) const;  ///< different ones in [first, first + count)
};
ReadLog ReadWhole(const MessageSource& source);
ReadLog ReadWhole(const std::filesystem::path& log);

/// 0, 1, ... 709
std::vector<std::size_t> AllSamples();

/// A file of this test process, removed with the object.
class ScratchFile {
 public:
  explicit ScratchFile(const std::string& extension);
  ~ScratchFile();
  const std::filesystem::path& path() const { return path_; }
  void Write(const std::vector<std::uint8_t>& bytes) const;

 private:
  std::filesystem::path path_;
};

std::vector<std::uint8_t> ReadBytes(const std::filesystem::path& file);

}  // namespace parkade

/// Skips a test whose sample cannot be made on this machine.
#define PARKADE_SKIP_WITHOUT(sample) \
  if (!(sample))                     \
  GTEST_SKIP() << "needs scripts/install_packages.sh and scripts/install_node_modules.sh"
