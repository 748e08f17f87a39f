#include "server/ingest/drive/timestamp_filter.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

/// Pushes stamps [ms] and gives back those that came through.
std::vector<int> Filtered(bool is_imu, const std::vector<int>& stamps_ms,
                          const std::vector<int>& imu_fronts_ms, StreamHealth& health) {
  TimestampFilter guard(is_imu);
  std::vector<int> passed;
  const auto keep = [&](const std::vector<Arrival>& arrivals) {
    for (const Arrival& arrival : arrivals)
      passed.push_back(static_cast<int>(arrival.time.ns / 1'000'000));
  };
  std::optional<Timestamp> front;
  for (std::size_t i = 0; i < stamps_ms.size(); ++i) {
    if (!imu_fronts_ms.empty())
      front = Timestamp{imu_fronts_ms[std::min(i, imu_fronts_ms.size() - 1)] * 1'000'000LL};
    keep(guard.Push({Timestamp{stamps_ms[i] * 1'000'000LL}, 0, WheelSample{}}, front, health));
  }
  keep(guard.Finish(front, health));
  return passed;
}

std::vector<int> Range(int begin, int end, int step) {
  std::vector<int> values;
  for (int i = begin; i < end; i += step) values.push_back(i);
  return values;
}

TEST(TimestampFilter, AnOrderlyImuPassesWhole) {
  StreamHealth health;
  EXPECT_EQ(Filtered(true, Range(100'000, 101'000, 10), {}, health), Range(100'000, 101'000, 10));
  EXPECT_EQ(health.NumDropped(), 0u);
}

TEST(TimestampFilter, ALoneJumpOfTheImuIsDroppedWhereverItStands) {
  for (const std::size_t place :
       {std::size_t{0}, std::size_t{3}, std::size_t{50}, std::size_t{99}}) {
    for (const int jump : {3'600'000, 5'000, -50'000}) {
      std::vector<int> stamps = Range(100'000, 101'000, 10);
      stamps[place] += jump;

      StreamHealth health;
      std::vector<int> expected = Range(100'000, 101'000, 10);
      expected.erase(expected.begin() + static_cast<std::ptrdiff_t>(place));
      EXPECT_EQ(Filtered(true, stamps, {}, health), expected) << place << " " << jump;
      EXPECT_EQ(health.NumDropped(), 1u);
    }
  }
}

TEST(TimestampFilter, AnImageThatIsAheadByAGlitchIsDroppedAlone) {
  const std::vector<int> imu = Range(100'000, 110'000, 200);
  for (const int jump : {1'500, 2'000, 3'600'000}) {
    std::vector<int> stamps = imu;
    stamps[20] += jump;

    StreamHealth health;
    std::vector<int> expected = imu;
    expected.erase(expected.begin() + 20);
    EXPECT_EQ(Filtered(false, stamps, imu, health), expected) << jump;
    EXPECT_EQ(health.NumDropped(), 1u);
  }
}

TEST(TimestampFilter, AGapOfTheImuLosesNothing) {
  std::vector<int> stamps = Range(100'000, 101'000, 10);
  for (const int stamp : Range(200'000, 201'000, 10)) stamps.push_back(stamp);

  StreamHealth health;
  EXPECT_EQ(Filtered(true, stamps, {}, health), stamps);
  EXPECT_NEAR(health.longest_gap, 99.01, 1e-9);
}

TEST(TimestampFilter, AClockSetBackIsCountedAndTheRestLeftOut) {
  std::vector<int> stamps = Range(100'000, 101'000, 10);
  for (const int stamp : Range(50'000, 50'500, 10)) stamps.push_back(stamp);

  StreamHealth health;
  EXPECT_EQ(Filtered(true, stamps, {}, health), Range(100'000, 101'000, 10));
  EXPECT_EQ(health.Dropped(DropReason::kBackwardStamp), 50u);
}

TEST(TimestampFilter, AnotherStreamFollowsAGapOnceTheImuIsThere) {
  StreamHealth health;
  const std::vector<int> stamps = {100'000, 100'050, 160'000, 160'050, 160'100};
  const std::vector<int> imu = {100'000, 100'050, 100'060, 160'060, 160'100};

  EXPECT_EQ(Filtered(false, stamps, imu, health), stamps);
  EXPECT_EQ(health.NumDropped(), 0u);
}

TEST(TimestampFilter, AStreamOnAnotherClockIsLeftOut) {
  StreamHealth health;
  EXPECT_TRUE(
      Filtered(false, Range(900'000, 901'000, 50), Range(100'000, 101'000, 50), health).empty());
  EXPECT_EQ(health.Dropped(DropReason::kOffClock), 20u);
}

TEST(TimestampFilter, ASlowStreamPasses) {
  StreamHealth health;
  EXPECT_EQ(Filtered(false, Range(100'000, 120'000, 2'000), Range(100'000, 120'000, 2'000), health),
            Range(100'000, 120'000, 2'000));
}

}  // namespace
}  // namespace parkade
