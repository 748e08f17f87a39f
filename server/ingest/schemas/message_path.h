#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/ingest/schemas/message_schema.h"

namespace parkade {

/// The way to a value in a message: `twist.linear.x`, `data[3]`, `velocity[name=rear_left]` (the
/// element at the place where `name`, beside it, is "rear_left"; or, in an array of messages, the
/// one whose `name` is that: `wheels[name=rear_left].speed`).
class MessagePath {
 public:
  /// Throws Error{kInvalidInput} when it is not written so.
  explicit MessagePath(const std::string& text);

  const std::string& text() const { return text_; }

  /// The number there (true is 1; a text that is a number counts). NaN where it is null; 0 where a
  /// part above it was not sent, as protobuf has it; nothing where there is no such field or
  /// element, or no number.
  std::optional<double> Number(const MessageTree& message) const;

  /// The names that there are where the path asks for one that there is not: the joints' of
  /// `velocity[name=rear_left]`. Empty where it fails otherwise, or not at all.
  std::vector<std::string> NamesInstead(const MessageTree& message) const;

 private:
  struct Step {
    std::string field = "";             ///< empty: an element
    std::size_t index = 0;              ///< of an element
    std::string key = "", wanted = "";  ///< of an element that has a name
  };

  std::string text_;
  std::vector<Step> steps_;
};

/// "header.stamp.sec, speed and data[0..7]": the paths to the numbers of a message, at most 40.
std::string ListNumbers(const MessageTree& message);

/// The time in `header.stamp`, `timestamp` or `stamp`, whatever its parts are called (`sec`,
/// `secs`, `seconds`; `nsec`, `nsecs`, `nanosec`, `nanos`); 0 where there is none.
Timestamp StampIn(const MessageTree& message);

// Values of a message by the name of a field. Where there is none: zero, empty.
double NumberAt(const MessageTree& message, const char* path);
std::string TextAt(const MessageTree& message, const std::string& field);
/// Bytes, or a text in base64 (RFC 4648). Throws Error{kInvalidInput} when it is none.
std::vector<std::uint8_t> BytesAt(const MessageTree& message, const std::string& field);
/// The numbers of an array, in any form.
std::vector<double> NumbersAt(const MessageTree& message, const std::string& field);

}  // namespace parkade
