#pragma once

#include <optional>

#include "core/drive_log.h"
#include "server/ingest/containers/raw_message.h"
#include "server/ingest/messages/message_decoding.h"
#include "server/ingest/messages/sensor_stream.h"

namespace parkade {

// Turns messages of any encoding into the records of core/drive_log.h, on the stamps of the log (no
// time shift). All throw Error{kInvalidInput} when the bytes do not hold the message. Nothing is
// known to be finite: see IsPlausible.

/// The stamp of a message of this type, or the log time where that is zero.
Timestamp StampOf(const RawMessage& message, MessageEncoding encoding, const std::string& type);

ImuSample ReadImuSample(const RawMessage& message, const SensorStream& stream);

/// Decodes a GNSS message; nothing without a fix. An unknown covariance becomes 5 m horizontal, 10
/// m vertical.
std::optional<GnssFix> ReadGnssFix(const RawMessage& message, const SensorStream& stream);

OdometryMessage ReadOdometry(const RawMessage& message, const SensorStream& stream);

/// Reads the wheel messages of one pass in order.
class WheelReader {
 public:
  /// The speed by the twist; or by the difference to the pose before (nothing for the first), at
  /// the time midway.
  std::optional<WheelSample> Read(const RawMessage& message, const SensorStream& stream);

  /// True when every twist so far was zero while the pose moved by more than 0.1 m.
  bool HasOnlyPoses() const { return has_pose_ && !has_twist_ && path_length_ > 0.1; }

 private:
  std::optional<WheelSample> FromPoses(Timestamp time, const OdometryMessage& message) const;

  bool has_pose_ = false, has_twist_ = false;
  double path_length_ = 0;  ///< [m]
  std::optional<Timestamp> last_time_;
  Rigid3 last_pose_;
};

// Whether all is finite, and within what a sensor of a car can measure (4000 deg/s, 200 g, 150 m/s;
// a place on Earth).
bool IsPlausible(const ImuSample& sample);
bool IsPlausible(const WheelSample& sample);
bool IsPlausible(const GnssFix& fix);

}  // namespace parkade
