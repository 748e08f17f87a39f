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

struct McapWriterOptions {
  LogCompression compression = LogCompression::kNone;
  std::size_t chunk_size = std::size_t{1} << 20;  ///< [byte] of messages per chunk
  bool has_chunks = true;                         ///< false: every message stands alone
  bool has_message_index = true;                  ///< index records behind each chunk
  bool has_summary = true;                        ///< topics, chunk index and statistics at the end
  bool has_checksums = true;                      ///< false: every CRC is 0, "not available"
};

/// Writes MCAP logs (mcap.dev/spec). Messages are written in the order given. Throws
/// as ThrowCannotWrite. A file whose Close() was not called ends as
/// after a crash of the recorder.
class McapWriter {
 public:
  /// `profile`: "ros1" or "ros2".
  McapWriter(const std::filesystem::path& file, const std::string& profile,
             const McapWriterOptions& options = {});

  /// A new topic. `type`: "sensor_msgs/Imu" (ros1) or "sensor_msgs/msg/Imu" (ros2); `schema_text`:
  /// the definition as in a .msg file, a serialized FileDescriptorSet or a JSON schema; `encoding`:
  /// "ros1", "cdr", "protobuf" or "json". The channel for Write().
  int AddChannel(const std::string& topic, const std::string& type, const std::string& schema_text,
                 const std::string& encoding);
  void Write(int channel, Timestamp time, std::span<const std::uint8_t> data);
  void Close();

 private:
  struct Channel {
    std::vector<std::uint8_t> schema_record, channel_record;
    std::uint64_t num_messages = 0;
    bool is_written = false;
  };
  struct ChunkIndex {
    std::uint64_t begin = 0, length = 0, index_length = 0, packed_size = 0, size = 0;
    TimeSpan time;
    std::map<std::uint16_t, std::uint64_t> index_offsets;
  };

  void Emit(std::span<const std::uint8_t> bytes);
  void FinishChunk();
  void WriteMessageIndex(ChunkIndex& index);
  void WriteSummary();

  McapWriterOptions options_;
  std::filesystem::path path_;
  std::ofstream file_;
  std::uint64_t offset_ = 0;
  std::uint32_t crc_ = 0;  ///< of what Emit() wrote since it was last set to zero
  std::vector<Channel> channels_;
  ByteWriter chunk_;
  TimeSpan chunk_time_, time_;
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> message_index_;
  std::vector<ChunkIndex> chunks_;
};

}  // namespace parkade
