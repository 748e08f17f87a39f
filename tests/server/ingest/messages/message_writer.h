#pragma once

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "server/ingest/containers/raw_message.h"

namespace parkade {

/// Serializes ROS messages for tests: ROS 1 by hand, CDR by eProsima's library. Shares no code with
/// the readers.
class MessageWriter {
 public:
  explicit MessageWriter(MessageEncoding encoding, bool is_big_endian = false)
      : is_cdr_(encoding == MessageEncoding::kCdr),
        cdr_(buffer_,
             is_big_endian ? eprosima::fastcdr::Cdr::BIG_ENDIANNESS
                           : eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS,
             eprosima::fastcdr::Cdr::DDS_CDR) {
    if (is_cdr_) cdr_.serialize_encapsulation();
  }

  template <typename T>
  MessageWriter& Put(T value) {
    if (is_cdr_) {
      cdr_.serialize(value);
    } else {
      const auto* bytes = reinterpret_cast<const std::uint8_t*>(&value);
      ros1_.insert(ros1_.end(), bytes, bytes + sizeof(T));
    }
    return *this;
  }

  MessageWriter& Doubles(std::initializer_list<double> values) {
    for (const double value : values) Put(value);
    return *this;
  }
  MessageWriter& Zeros(int count) {
    for (int i = 0; i < count; ++i) Put(0.0);
    return *this;
  }

  MessageWriter& Text(const std::string& text) {
    if (is_cdr_) {
      cdr_.serialize(text);
      return *this;
    }
    Put(static_cast<std::uint32_t>(text.size()));
    ros1_.insert(ros1_.end(), text.begin(), text.end());
    return *this;
  }

  MessageWriter& Bytes(const std::vector<std::uint8_t>& bytes) {
    if (is_cdr_) {
      cdr_.serialize(bytes);
      return *this;
    }
    Put(static_cast<std::uint32_t>(bytes.size()));
    ros1_.insert(ros1_.end(), bytes.begin(), bytes.end());
    return *this;
  }

  MessageWriter& Header(std::int64_t stamp_ns, const std::string& frame) {
    if (!is_cdr_) Put(std::uint32_t{42});  // sequence number
    Put(static_cast<std::uint32_t>(stamp_ns / 1'000'000'000));
    Put(static_cast<std::uint32_t>(stamp_ns % 1'000'000'000));
    return Text(frame);
  }

  std::vector<std::uint8_t> Take() {
    if (!is_cdr_) return ros1_;
    const auto* begin = reinterpret_cast<const std::uint8_t*>(buffer_.getBuffer());
    return {begin, begin + cdr_.getSerializedDataLength()};
  }

 private:
  bool is_cdr_;
  std::vector<std::uint8_t> ros1_;
  eprosima::fastcdr::FastBuffer buffer_;
  eprosima::fastcdr::Cdr cdr_;
};

// Each with its own values in every field that is read.

inline std::vector<std::uint8_t> ImuBytes(MessageWriter writer, std::int64_t stamp_ns,
                                          const std::string& frame = "imu") {
  return writer.Header(stamp_ns, frame)
      .Zeros(13)
      .Doubles({0.1, 0.2, 0.3})
      .Zeros(9)
      .Doubles({1, 2, 9.8})
      .Zeros(9)
      .Take();
}

struct OdometryValues {
  double x = 0, y = 0, yaw = 0, speed = 0, yaw_rate = 0;
};

inline std::vector<std::uint8_t> OdometryBytes(MessageWriter writer, std::int64_t stamp_ns,
                                               const OdometryValues& values) {
  writer.Header(stamp_ns, "odom").Text("base_link").Doubles({values.x, values.y, 0});
  writer.Doubles({0, 0, std::sin(values.yaw / 2), std::cos(values.yaw / 2)}).Zeros(36);
  return writer.Doubles({values.speed, 0.01, 0.02, 0, 0, values.yaw_rate}).Zeros(36).Take();
}

inline std::vector<std::uint8_t> TwistBytes(MessageWriter writer, std::int64_t stamp_ns,
                                            double speed, double yaw_rate, bool has_covariance) {
  return writer.Header(stamp_ns, "base_link")
      .Doubles({speed, 0, 0, 0, 0, yaw_rate})
      .Zeros(has_covariance ? 36 : 0)
      .Take();
}

inline std::vector<std::uint8_t> NavSatBytes(MessageWriter writer, std::int64_t stamp_ns,
                                             int status, double variance, int covariance_type) {
  writer.Header(stamp_ns, "gnss").Put(static_cast<std::int8_t>(status)).Put(std::uint16_t{1});
  writer.Doubles({48.1, 11.5, 512.25, variance, 0, 0, 0, 2 * variance, 0, 0, 0, 3 * variance});
  return writer.Put(static_cast<std::uint8_t>(covariance_type)).Take();
}

struct CameraInfoValues {
  std::uint32_t width = 64, height = 48;
  std::string model = "plumb_bob";
  std::vector<double> distortion = {-0.1, 0.01, 0.001, 0.002, 0.003};
  double focal = 40;
};

inline std::vector<std::uint8_t> CameraInfoBytes(MessageWriter writer, std::int64_t stamp_ns,
                                                 const std::string& frame,
                                                 const CameraInfoValues& values = {}) {
  const double f = values.focal;
  writer.Header(stamp_ns, frame).Put(values.height).Put(values.width).Text(values.model);
  writer.Put(static_cast<std::uint32_t>(values.distortion.size()));
  for (const double d : values.distortion) writer.Put(d);
  writer.Doubles({f, 0, 31.5, 0, f + 1, 23.5, 0, 0, 1}).Doubles({1, 0, 0, 0, 1, 0, 0, 0, 1});
  writer.Doubles({f + 2, 0, 30.5, 0, 0, f + 3, 22.5, 0, 0, 0, 1, 0});
  for (int i = 0; i < 6; ++i) writer.Put(std::uint32_t{0});  // binning and region of interest
  return writer.Put(std::uint8_t{0}).Take();
}

struct TransformValues {
  std::string parent, child;
  std::array<double, 3> translation{};
  std::array<double, 4> rotation = {0, 0, 0, 1};  ///< x y z w
};

inline std::vector<std::uint8_t> TransformBytes(MessageWriter writer,
                                                const std::vector<TransformValues>& transforms) {
  writer.Put(static_cast<std::uint32_t>(transforms.size()));
  for (const TransformValues& transform : transforms) {
    writer.Header(1, transform.parent).Text(transform.child);
    for (const double value : transform.translation) writer.Put(value);
    for (const double value : transform.rotation) writer.Put(value);
  }
  return writer.Take();
}

struct ImageValues {
  std::uint32_t width = 0, height = 0, step = 0;
  std::string encoding = "mono8";
  bool is_bigendian = false;
  std::vector<std::uint8_t> data;
};

inline std::vector<std::uint8_t> ImageBytes(MessageWriter writer, std::int64_t stamp_ns,
                                            const std::string& frame, const ImageValues& image) {
  writer.Header(stamp_ns, frame).Put(image.height).Put(image.width).Text(image.encoding);
  writer.Put(static_cast<std::uint8_t>(image.is_bigendian)).Put(image.step);
  return writer.Bytes(image.data).Take();
}

inline std::vector<std::uint8_t> CompressedImageBytes(MessageWriter writer, std::int64_t stamp_ns,
                                                      const std::string& frame,
                                                      const std::vector<std::uint8_t>& data) {
  return writer.Header(stamp_ns, frame).Text("jpeg").Bytes(data).Take();
}

/// A log in memory, whose messages come in the order in which they were added.
class MemorySource : public MessageSource {
 public:
  explicit MemorySource(MessageEncoding encoding = MessageEncoding::kRos1) : encoding_(encoding) {}

  MessageWriter Writer() const { return MessageWriter(encoding_); }

  void Add(const std::string& topic, const std::string& type, std::int64_t log_time_ns,
           std::vector<std::uint8_t> data) {
    std::size_t index = 0;
    while (index < topics_.size() && topics_[index].topic != topic) ++index;
    if (index == topics_.size()) topics_.push_back({topic, type, encoding_, 0});
    ++topics_[index].num_messages;
    messages_.push_back({static_cast<int>(index), Timestamp{log_time_ns}, std::move(data),
                         MessagePlace{messages_.size()}});
  }

  const std::vector<TopicInfo>& topics() const override { return topics_; }
  std::string format() const override { return "memory"; }
  std::unique_ptr<MessageStream> Read(const std::vector<bool>& wanted) const override {
    return std::make_unique<Stream>(*this, wanted);
  }
  std::optional<RawMessage> ReadAt(int topic, const MessagePlace& place) const override {
    if (place.record >= messages_.size() || messages_[place.record].topic != topic) return {};
    return messages_[place.record];
  }

  DamageReport damage;

 private:
  class Stream : public MessageStream {
   public:
    Stream(const MemorySource& source, const std::vector<bool>& wanted)
        : source_(source), wanted_(wanted) {}
    std::optional<RawMessage> Next() override {
      while (next_ < source_.messages_.size()) {
        const RawMessage& message = source_.messages_[next_++];
        if (wanted_[static_cast<std::size_t>(message.topic)]) return message;
      }
      return std::nullopt;
    }
    const DamageReport& damage() const override { return source_.damage; }

   private:
    const MemorySource& source_;
    std::vector<bool> wanted_;
    std::size_t next_ = 0;
  };

  MessageEncoding encoding_;
  std::vector<TopicInfo> topics_;
  std::vector<RawMessage> messages_;
};

}  // namespace parkade
