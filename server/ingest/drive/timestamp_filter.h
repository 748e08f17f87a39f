#pragma once

#include <deque>
#include <optional>
#include <variant>
#include <vector>

#include "core/drive_log.h"
#include "server/ingest/drive/drive_log_health.h"
#include "server/ingest/video/encoded_image.h"

namespace parkade {

/// A record of one stream, on the IMU's clock, before images are decoded.
struct Arrival {
  Timestamp time;
  int stream = 0;  ///< index into the drive's streams
  std::variant<ImuSample, WheelSample, GnssFix, EncodedImage> content;
};

/// Keeps the stamps of one stream strictly increasing and on the drive's clock, which is the IMU's.
///
/// A record follows when it is at most 1 s after the one before. One further ahead is held back: it
/// follows once the IMU has come near its time (then the stream had a gap), by half a second more
/// than the stream led the IMU before, and is dropped when the stream goes on as before (a lone
/// jump) or runs ahead for long (another clock). The IMU itself is believed after five records in a
/// row.
class TimestampFilter {
 public:
  explicit TimestampFilter(bool is_imu) : is_imu_(is_imu) {}

  /// The records that are now known to be good, in order. `imu_front`: time of the newest good IMU
  /// sample. Drops are counted in `health`.
  std::vector<Arrival> Push(Arrival arrival, const std::optional<Timestamp>& imu_front,
                            StreamHealth& health);

  /// Call at the end of the log: the held records that are good after all.
  std::vector<Arrival> Finish(const std::optional<Timestamp>& imu_front, StreamHealth& health);

 private:
  bool IsNear(Timestamp time, const std::optional<Timestamp>& imu_front) const;
  void ReleaseHeld(const std::optional<Timestamp>& imu_front, StreamHealth& health,
                   std::vector<Arrival>& released);
  void Accept(Arrival arrival, StreamHealth& health, std::vector<Arrival>& released);
  void DropHeld(StreamHealth& health);
  void DropOneHeld(StreamHealth& health);

  bool is_imu_;
  std::optional<Timestamp> last_;
  double lead_ = 0;  ///< [s] of the last record that followed, ahead of the IMU; at least 0
  std::deque<Arrival> held_;  ///< at most kMaxHeld, in order of time
  double held_by_ = 0;        ///< [s] ahead of the IMU, of the first that was held
  std::size_t num_challenges_ =
      0;  ///< records that contradict the held ones; as many as there are of these outvote them
};

}  // namespace parkade
