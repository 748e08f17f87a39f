#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/timestamp.h"

namespace parkade {

/// How a message's bytes are to be read. kEuroc: a line of a data.csv, for images the path of the
/// file. kProtobuf and kJson mean nothing without the topic's schema: see ingest/schemas.
enum class MessageEncoding { kRos1, kCdr, kEuroc, kProtobuf, kJson };

/// One topic of a log file.
struct TopicInfo {
  std::string topic;  ///< "/cam0/image_raw"
  std::string type;   ///< ROS 1 spelling: "sensor_msgs/Image", even where the log says
                      ///< "sensor_msgs/msg/Image"
  MessageEncoding encoding = MessageEncoding::kRos1;
  std::uint64_t num_messages = 0;  ///< as far as known from the index
  /// What the log has to describe the type: the text of a .msg file and of those that it needs, a
  /// serialized google.protobuf.FileDescriptorSet, a JSON schema. Null where it has none.
  std::shared_ptr<const std::string> schema = nullptr;
  /// The type as the log names it, where messages are turned into ROS messages of `type`.
  std::string native_type = "";
  /// What had to be guessed to read it, in one phrase that names it; empty: nothing.
  std::string remark = "";
};

/// Where a message lies in its log.
struct MessagePlace {
  std::uint64_t record = 0;    ///< offset in the file of its record, or its chunk's; a row's number
  std::uint64_t in_chunk = 0;  ///< offset of its record in the unpacked chunk
  std::uint64_t part = 0;      ///< of a recording in several files
};

/// One serialized message. `data` owns its bytes.
struct RawMessage {
  int topic = 0;  ///< index into MessageSource::topics()
  Timestamp log_time;
  std::vector<std::uint8_t> data;
  MessagePlace place = {};
};

/// A stretch of a log that could not be read.
struct LostRange {
  std::string what;                ///< one sentence: "chunk at byte 812345 has a wrong checksum"
  std::string topic;               ///< empty: unknown or several
  TimeSpan time;                   ///< as far as known; may be empty
  std::uint64_t num_messages = 0;  ///< as far as known
};

/// The losses while reading; grows during a pass.
struct DamageReport {
  std::vector<LostRange> ranges;  ///< at most 1000 kept
  std::uint64_t num_lost_messages = 0;
  bool is_truncated = false;
  bool IsClean() const { return ranges.empty() && num_lost_messages == 0 && !is_truncated; }
};

/// One pass over the messages of a log, about in order of log_time.
class MessageStream {
 public:
  virtual ~MessageStream() = default;
  virtual std::optional<RawMessage> Next() = 0;
  virtual const DamageReport& damage() const = 0;
};

/// A log file of messages: ROS 1 bag, MCAP, rosbag2 sqlite3. Opening scans only
/// headers and indexes; memory does not grow with the file.
class MessageSource {
 public:
  virtual ~MessageSource() = default;
  virtual const std::vector<TopicInfo>& topics() const = 0;
  virtual std::string format() const = 0;  ///< "ROS 1 bag", "MCAP", "rosbag2 sqlite3"
  /// A new pass over the topics with `wanted[topic]` set. Thread rule: passes
  /// are independent of each other.
  virtual std::unique_ptr<MessageStream> Read(const std::vector<bool>& wanted) const = 0;
  /// The message of a topic at a place that a pass over this log gave, without a pass; nothing
  /// where it cannot be read there.
  virtual std::optional<RawMessage> ReadAt(int topic, const MessagePlace& place) const = 0;
  /// From the earliest log time to the latest; empty where only reading would tell.
  virtual TimeSpan span() const { return {}; }
  /// The source that was opened, where this shows part of it.
  virtual const MessageSource& origin() const { return *this; }
};

}  // namespace parkade
