#pragma once

#include <functional>
#include <map>
#include <string>

#include "server/ingest/containers/channel_table.h"
#include "server/ingest/containers/log_record.h"
#include "server/ingest/files/byte_reader.h"

namespace parkade {

struct ChunkIndexEntry {
  Timestamp time;
  std::uint64_t offset = 0;  ///< of the message's record in the unpacked chunk
};

/// The summary at the end of a log.
struct LogSummary {
  bool is_closed = false;  ///< the recorder came to its end, and the file is as long as it was then
  std::optional<std::uint64_t> num_channels;            ///< of the whole log
  std::map<std::uint32_t, std::uint64_t> num_messages;  ///< by channel, where told
  std::string problem;                                  ///< one sentence, or empty
};

/// A file format of records with a length in front. Thread-safe: no state.
class LogFormat {
 public:
  virtual ~LogFormat() = default;

  virtual std::string name() const = 0;

  /// The offsets where the records begin and end in a file.
  virtual std::uint64_t FirstRecord() const = 0;
  virtual std::uint64_t EndOfRecords(const InputFile& file) const = 0;

  /// The record at `offset`, or nothing when there can be none. Only a message or a chunk may claim
  /// to go on behind the reader's end. Reads headers only.
  virtual std::optional<LogRecord> Parse(ByteReader& reader, std::uint64_t offset) const = 0;

  /// The first index from `begin` on at which a record may start, for a quick look at many bytes;
  /// bytes.size() - 15 or later when there is none.
  virtual std::size_t FindCandidate(std::span<const std::uint8_t> bytes,
                                    std::size_t begin) const = 0;

  /// Reads a definition.
  virtual void Learn(ByteReader& reader, const LogRecord& record, ChannelTable& channels) const = 0;

  virtual void ReadIndex(ByteReader& reader, const LogRecord& record,
                         const std::function<void(const ChunkIndexEntry&)>& add) const = 0;

  virtual LogSummary ReadSummary(const InputFile& file, ChannelTable& channels) const = 0;
};

const LogFormat& McapFormat();
const LogFormat& Rosbag1Format();

}  // namespace parkade
