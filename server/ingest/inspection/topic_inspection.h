#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/timestamp.h"
#include "server/ingest/containers/raw_message.h"
#include "server/ingest/inspection/image_history.h"

namespace parkade {

/// The content of one topic of a log, by its stamps as recorded.
struct TopicInspection {
  struct Gap {
    Timestamp begin;
    double seconds = 0;
  };

  std::string topic, type;
  std::uint64_t num_messages = 0, num_bytes = 0;
  TimeSpan span;
  double median_step = 0;  ///< [s] between messages
  std::vector<Gap>
      gaps;  ///< of sensors: steps above three median steps and 0.1 s, longest first, at most 10
  std::uint64_t num_repeated = 0;       ///< same stamp as the message before
  std::uint64_t num_backward = 0;       ///< stamp before that of the message before
  double largest_backward_jump = 0;     ///< [s]
  std::uint64_t num_without_stamp = 0;  ///< header.stamp is zero: the log time stands in
  std::uint64_t num_undecodable = 0;    ///< messages and images that are damaged or not supported
  std::uint64_t num_implausible = 0;    ///< NaN, infinite or out of any sensor's range
  std::string first_fault;              ///< of these, with the time
  int width = 0, height = 0;            ///< [px] of the first good image
  std::uint64_t num_other_sizes = 0;    ///< images of another size than the first
  std::string image_encoding;           ///< "mono8", "jpeg", ...
  std::vector<CameraFault>
      image_faults;  ///< of cameras: dark, unchanged, covered; at most 10 of each

  double RateHz() const { return median_step > 0 ? 1 / median_step : 0; }
  std::uint64_t NumLost() const {
    return num_undecodable + num_implausible + num_backward + num_other_sizes;
  }
};

/// Collects a TopicInspection from messages in the order of the log.
class TopicInspector {
 public:
  explicit TopicInspector(const TopicInfo& topic);

  /// Call for every message.
  void IncludeMessage(const RawMessage& message);
  /// Call for images, once decoded.
  void IncludeImage(Timestamp time, int width, int height);
  void IncludeFault(Timestamp time, const std::string& what);

  /// The time by which faults are reported: the last stamp.
  Timestamp last_stamp() const { return last_stamp_; }

  TopicInspection Finish() const;

 private:
  void IncludeStamp(Timestamp stamp);
  void CheckContent(const RawMessage& message);

  TopicInfo topic_;
  TopicInspection found_;
  Timestamp last_stamp_;
  std::vector<double> first_steps_;               ///< [s], for the median
  std::vector<TopicInspection::Gap> long_steps_;  ///< longest first
};

}  // namespace parkade
