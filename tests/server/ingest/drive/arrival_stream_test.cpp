#include "server/ingest/drive/arrival_stream.h"

#include <gtest/gtest.h>

#include "tests/server/ingest/messages/message_writer.h"

namespace parkade {
namespace {

constexpr std::int64_t kBegin = 1'700'000'000'000'000'000, kMs = 1'000'000;

/// Ten seconds of an IMU and wheels at 100 Hz.
MemorySource LogOfImuAndWheels() {
  MemorySource log;
  for (int ms = 0; ms < 10'000; ms += 10) {
    log.Add("/imu", "sensor_msgs/Imu", kBegin + ms * kMs,
            ImuBytes(log.Writer(), kBegin + ms * kMs));
    log.Add("/odom", "nav_msgs/Odometry", kBegin + ms * kMs,
            OdometryBytes(log.Writer(), kBegin + ms * kMs, {.speed = 2}));
  }
  return log;
}

std::vector<SensorStream> StreamsOf(const MemorySource& log) {
  std::vector<SensorStream> streams(2);
  for (std::size_t i = 0; i < 2; ++i) {
    streams[i].kind = i == 0 ? StreamKind::kImu : StreamKind::kWheels;
    streams[i].topic = static_cast<int>(i);
    streams[i].topic_name = log.topics()[i].topic;
    streams[i].type = log.topics()[i].type;
  }
  return streams;
}

std::vector<Arrival> Read(const MemorySource& log, const std::vector<SensorStream>& streams,
                          std::vector<StreamHealth>* health = nullptr) {
  ArrivalStream arrivals(log, streams, {true, true}, nullptr);
  std::vector<Arrival> all;
  while (std::optional<Arrival> arrival = arrivals.Next()) all.push_back(std::move(*arrival));
  if (health) *health = arrivals.health();
  return all;
}

TEST(ArrivalStream, CorrectsTheTimesOfSamplesToo) {
  const MemorySource log = LogOfImuAndWheels();
  std::vector<SensorStream> streams = StreamsOf(log);
  streams[0].clock = {{0, 0, 0}, {500, 0.25, 0}};
  streams[1].time_shift = -0.125;

  const std::vector<Arrival> arrivals = Read(log, streams);

  ASSERT_EQ(arrivals.size(), 2000u);
  for (const Arrival& arrival : arrivals) {
    if (const auto* imu = std::get_if<ImuSample>(&arrival.content))
      ASSERT_EQ(imu->time, arrival.time);
    else
      ASSERT_EQ(std::get<WheelSample>(arrival.content).time, arrival.time);
  }
  EXPECT_EQ(arrivals.back().time.ns, kBegin + 9'990 * kMs + 250 * kMs);
}

TEST(ArrivalStream, LeavesOutWhatADriverRepeats) {
  const MemorySource log = LogOfImuAndWheels();
  std::vector<SensorStream> streams = StreamsOf(log);
  streams[0].stuck = {{Timestamp{kBegin + 2'000 * kMs}, Timestamp{kBegin + 2'990 * kMs}}};

  std::vector<StreamHealth> health;
  EXPECT_EQ(Read(log, streams, &health).size(), 1900u);
  EXPECT_EQ(health[0].Dropped(DropReason::kStuck), 100u);
}

}  // namespace
}  // namespace parkade
