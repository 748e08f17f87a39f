// Writes small whole logs for the fuzzers to begin with: write_seeds FOLDER

#include <sqlite3.h>

#include <filesystem>
#include <string>
#include <vector>

#include "server/ingest/writing/mcap_writer.h"
#include "tests/support/rosbag1_writer.h"

namespace {

using namespace parkade;

const std::vector<std::string> kTopics = {"/imu", "/cam0"};
const std::vector<std::string> kTypes = {"Imu", "CompressedImage"};

/// A few messages of both topics by turns.
template <typename Writer>
void WriteMessages(Writer& writer, const std::vector<int>& channels) {
  for (int i = 0; i < 6; ++i)
    writer.Write(channels[static_cast<size_t>(i) % channels.size()],
                 Timestamp{1'700'000'000'000'000'000 + i * 10'000'000},
                 std::vector<std::uint8_t>(40, static_cast<std::uint8_t>(i)));
  writer.Close();
}

void WriteMcap(const std::filesystem::path& file, const std::string& profile,
               McapWriterOptions options) {
  options.chunk_size = 120;
  McapWriter writer(file, profile, options);
  const bool is_ros1 = profile == "ros1";
  std::vector<int> channels;
  for (size_t i = 0; i < kTopics.size(); ++i)
    channels.push_back(
        writer.AddChannel(kTopics[i], (is_ros1 ? "sensor_msgs/" : "sensor_msgs/msg/") + kTypes[i],
                          "uint8[] data", is_ros1 ? "ros1" : "cdr"));
  WriteMessages(writer, channels);
}

void WriteBag(const std::filesystem::path& file, LogCompression compression) {
  Rosbag1Writer writer(file, {.compression = compression, .chunk_size = 120});
  std::vector<int> channels;
  for (size_t i = 0; i < kTopics.size(); ++i)
    channels.push_back(
        writer.AddChannel(kTopics[i], "sensor_msgs/" + kTypes[i], "uint8[] data", "*"));
  WriteMessages(writer, channels);
}

void WriteRosbag2(const std::filesystem::path& file) {
  sqlite3* database = nullptr;
  sqlite3_open(file.c_str(), &database);
  sqlite3_exec(database, R"(
      PRAGMA page_size = 512;
      CREATE TABLE topics (id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
                           serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);
      CREATE TABLE messages (id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL,
                             timestamp INTEGER NOT NULL, data BLOB NOT NULL);
      INSERT INTO topics VALUES (1, '/imu', 'sensor_msgs/msg/Imu', 'cdr', '');
      INSERT INTO messages VALUES (1, 1, 1700000000000000000, x'00010000');
      INSERT INTO messages VALUES (2, 1, 1700000000010000000, x'0001000000000000');)",
               nullptr, nullptr, nullptr);
  sqlite3_close(database);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const std::filesystem::path folder = argv[1];
  for (const LogCompression compression :
       {LogCompression::kNone, LogCompression::kLz4, LogCompression::kBz2})
    WriteBag(folder / (std::string("seed") + NameOf(compression) + ".bag"), compression);
  for (const LogCompression compression :
       {LogCompression::kNone, LogCompression::kLz4, LogCompression::kZstd})
    WriteMcap(folder / (std::string("seed") + NameOf(compression) + ".mcap"), "ros2",
              {.compression = compression});
  WriteMcap(folder / "seed-ros1.mcap", "ros1", {.has_summary = false, .has_checksums = false});
  WriteMcap(folder / "seed-plain.mcap", "ros2", {.has_chunks = false, .has_checksums = false});
  WriteRosbag2(folder / "seed.db3");
}
