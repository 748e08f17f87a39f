#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "core/timestamp.h"

namespace parkade {

/// Writes a ROS 2 message: plain CDR, little endian, with its encapsulation header. OMG DDS-XTYPES
/// 1.3, 7.4.
class CdrWriter {
 public:
  template <typename T>
  CdrWriter& Put(T value) {
    static_assert(std::is_arithmetic_v<T>);
    while ((data_.size() - kHeaderSize) % sizeof(T) != 0) data_.push_back(0);
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(&value);
    data_.insert(data_.end(), bytes, bytes + sizeof(T));
    return *this;
  }

  /// Elements of an array of fixed length.
  CdrWriter& Doubles(std::span<const double> values) {
    for (const double value : values) Put(value);
    return *this;
  }

  CdrWriter& Text(const std::string& text) {
    Put(static_cast<std::uint32_t>(text.size() + 1));
    data_.insert(data_.end(), text.begin(), text.end());
    data_.push_back(0);
    return *this;
  }

  CdrWriter& Bytes(std::span<const std::uint8_t> bytes) {
    Put(static_cast<std::uint32_t>(bytes.size()));
    data_.insert(data_.end(), bytes.begin(), bytes.end());
    return *this;
  }

  /// A std_msgs/Header.
  CdrWriter& Header(Timestamp stamp, const std::string& frame_id) {
    constexpr std::int64_t kSecond = 1'000'000'000;
    Put(static_cast<std::int32_t>(stamp.ns / kSecond));
    Put(static_cast<std::uint32_t>(stamp.ns % kSecond));
    return Text(frame_id);
  }

  /// What was written; nothing is left.
  std::vector<std::uint8_t> Take() { return std::move(data_); }

 private:
  static constexpr std::size_t kHeaderSize = 4;

  std::vector<std::uint8_t> data_ = {0, 1, 0, 0};
};

}  // namespace parkade
