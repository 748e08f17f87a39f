#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "core/timestamp.h"
#include "server/ingest/writing/byte_writer.h"
#include "server/ingest/writing/log_compression.h"

namespace parkade {

struct Rosbag1WriterOptions {
  LogCompression compression = LogCompression::kNone;
  std::size_t chunk_size = std::size_t{768} << 10;  ///< [byte] of messages per chunk
};

/// Writes ROS 1 bags, format 2.0 (wiki.ros.org/Bags/Format/2.0). Messages are written in the order
/// given. Throws Error{kInternal} when the file cannot be written. A file whose Close() was not
/// called ends as after a crash of the recorder: without the index at its end.
class Rosbag1Writer {
 public:
  explicit Rosbag1Writer(const std::filesystem::path& file,
                         const Rosbag1WriterOptions& options = {});

  /// A new topic. `type`: "sensor_msgs/Imu"; `definition`: the full text as of `gendeps --cat`;
  /// `md5sum`: of the type (32 hexadecimal digits, or "*"). The channel for Write().
  int AddChannel(const std::string& topic, const std::string& type, const std::string& definition,
                 const std::string& md5sum);
  /// `time` must not be negative.
  void Write(int channel, Timestamp time, std::span<const std::uint8_t> data);
  void Close();

 private:
  struct Channel {
    std::vector<std::uint8_t> record;
    bool is_written = false;
  };
  struct Entry {
    Timestamp time;
    std::uint32_t offset = 0;  ///< in the chunk
  };
  struct ChunkInfo {
    std::uint64_t begin = 0;
    TimeSpan time;
    std::map<std::uint32_t, std::uint32_t> num_messages;
  };

  void Emit(std::span<const std::uint8_t> bytes);
  void EmitBagHeader(std::uint64_t index_begin);
  void FinishChunk();

  Rosbag1WriterOptions options_;
  std::string name_;
  std::ofstream file_;
  std::uint64_t offset_ = 0;
  std::vector<Channel> channels_;
  ByteWriter chunk_;
  TimeSpan chunk_time_;
  std::map<std::uint32_t, std::vector<Entry>> index_;
  std::vector<ChunkInfo> chunks_;
};

}  // namespace parkade
