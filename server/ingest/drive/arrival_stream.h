#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "server/ingest/containers/raw_message.h"
#include "server/ingest/drive/drive_log_health.h"
#include "server/ingest/drive/spike_filter.h"
#include "server/ingest/drive/timestamp_filter.h"
#include "server/ingest/messages/sensor_decoding.h"
#include "server/ingest/messages/sensor_stream.h"

namespace parkade {

/// One pass over the records of a drive in the order of the log: small ones decoded, images not;
/// each stream strictly increasing in time. The IMU is always read, since its clock judges the
/// other stamps.
class ArrivalStream {
 public:
  using Filter = std::function<bool(const Arrival& arrival)>;

  /// Delivers only streams with `wanted[stream]`, and only those of their arrivals that `filter`
  /// (where set) accepts. `source` and `streams` must outlive this.
  /// \param stretch  of the log, by the streams' clocks: only what lies in it is passed on
  ArrivalStream(const MessageSource& source, const std::vector<SensorStream>& streams,
                std::vector<bool> wanted, Filter filter, int stretch = 0);

  std::optional<Arrival> Next();

  /// Counts so far, one per stream; `num_delivered` counts good records before the filter.
  const std::vector<StreamHealth>& health() const { return health_; }
  const DamageReport& damage() const { return messages_->damage(); }

  /// True for the wheel stream when only its pose moved.
  bool HasWheelsWithOnlyPoses() const { return wheel_reader_.HasOnlyPoses(); }

 private:
  /// The run of the stream's clock that its next message belongs to.
  ClockRun NextRun(std::size_t stream);
  void Take(RawMessage message);
  void Release(std::vector<Arrival> arrivals);
  void Deliver(Arrival arrival);
  std::optional<Arrival> Decode(RawMessage message, int stream);

  const std::vector<SensorStream>& streams_;
  std::vector<bool> wanted_;
  Filter filter_;
  int stretch_;
  std::vector<std::uint64_t> num_taken_;  ///< per stream
  std::vector<std::size_t> run_;          ///< per stream, of its clock
  std::vector<int> stream_of_topic_;      ///< -1: none
  std::unique_ptr<MessageStream> messages_;
  std::vector<TimestampFilter> guards_;
  std::vector<StreamHealth> health_;
  SpikeFilter spikes_;  ///< of the IMU
  WheelReader wheel_reader_;
  std::vector<ImageIntake> images_;  ///< per stream
  std::optional<Timestamp> imu_front_;
  std::deque<Arrival> ready_;
  bool is_finished_ = false;
};

}  // namespace parkade
