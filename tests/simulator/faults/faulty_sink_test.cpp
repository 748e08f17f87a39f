#include "tests/simulator/faults/faulty_sink.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/error.h"

namespace parkade::simulator {
namespace {

/// One record as it arrived: its stamp in milliseconds, and a word about its content.
struct Entry {
  std::int64_t ms = 0;
  std::string content;
  bool operator==(const Entry&) const = default;
};

/// Keeps what it gets, by stream.
class MemorySink : public DriveSink {
 public:
  void Write(const ImuSample& sample) override {
    Add("imu", sample.time, sample.angular_velocity.x());
  }
  void Write(const WheelSample& sample) override {
    Add("wheels", sample.time, sample.forward_speed);
  }
  void Write(const GnssFix& fix) override { Add("gnss", fix.time, fix.altitude); }
  void WriteImage(size_t camera, Timestamp time, std::span<const std::uint8_t> jpeg) override {
    streams["cam" + std::to_string(camera)].push_back(
        {Ms(time), std::string(jpeg.begin(), jpeg.end())});
  }
  void WriteSemantic(size_t camera, Timestamp time, std::span<const std::uint8_t> png) override {
    streams["mask" + std::to_string(camera)].push_back(
        {Ms(time), std::string(png.begin(), png.end())});
  }
  void Close() override { is_closed = true; }

  std::map<std::string, std::vector<Entry>> streams;
  bool is_closed = false;

 private:
  static std::int64_t Ms(Timestamp time) {
    return std::llround(static_cast<double>(time.ns) * 1e-6);
  }
  void Add(const std::string& stream, Timestamp time, double value) {
    streams[stream].push_back({Ms(time), std::to_string(value)});
  }
};

struct Log {
  std::map<std::string, std::vector<Entry>> streams;
  std::map<std::string, size_t> counts;
};

/// Ten seconds of two cameras with masks and all sensors, through the faults.
Log RecordWith(const FaultOptions& faults) {
  MemorySink memory;
  FaultySink sink(memory, faults, Timestamp{0}, 3);
  for (int i = 0; i < 1000; ++i) {
    const Timestamp time{i * 10'000'000LL};
    sink.Write(ImuSample{time, {0.001 * i, 0, 0}, {0, 0, 9.8}});
    sink.Write(WheelSample{time, 0.01 * i, 0});
    if (i % 20 == 0) sink.Write(GnssFix{time, 48, 11, 1.0 * i});
    if (i % 10 != 0) continue;
    for (const size_t camera : {size_t{0}, size_t{1}}) {
      sink.WriteImage(camera, time,
                      std::vector<std::uint8_t>(1000, static_cast<std::uint8_t>(i / 10)));
      sink.WriteSemantic(camera, time,
                         std::vector<std::uint8_t>(10, static_cast<std::uint8_t>(i / 10)));
    }
  }
  sink.Close();
  EXPECT_TRUE(memory.is_closed);
  return {memory.streams, sink.counts()};
}

/// Names of the streams in which two logs differ.
std::vector<std::string> Differences(const Log& log, const Log& other) {
  std::vector<std::string> names;
  for (const auto& [name, entries] : log.streams) {
    const auto found = other.streams.find(name);
    if (found == other.streams.end() || found->second != entries) names.push_back(name);
  }
  return names;
}

using Names = std::vector<std::string>;

class FaultyLog : public testing::Test {
 protected:
  const Log clean_ = RecordWith({});
  FaultOptions faults_;
};

TEST_F(FaultyLog, WithoutFaultsEverythingPassesThrough) {
  EXPECT_TRUE(clean_.counts.empty());
  EXPECT_EQ(clean_.streams.at("imu").size(), 1000u);
  EXPECT_EQ(clean_.streams.at("gnss").size(), 50u);
  EXPECT_EQ(clean_.streams.at("cam1").size(), 100u);
  EXPECT_EQ(clean_.streams.at("mask1").size(), 100u);
}

TEST_F(FaultyLog, AGapIsInItsStreamAndInNoOther) {
  faults_.imu_gap = {4, 4.5};
  const Log log = RecordWith(faults_);

  EXPECT_EQ(Differences(clean_, log), Names{"imu"});
  EXPECT_EQ(log.streams.at("imu").size(), 950u);
  EXPECT_EQ(log.counts, (std::map<std::string, size_t>{{"gap.imu", 50}}));
  for (const Entry& entry : log.streams.at("imu"))
    EXPECT_FALSE(entry.ms >= 4000 && entry.ms < 4500);
}

TEST_F(FaultyLog, GapsOfWheelsAndGnssAreTheirOwn) {
  faults_.wheel_gap = {1, 2};
  faults_.gnss_gap = {3, 5};

  EXPECT_EQ(Differences(clean_, RecordWith(faults_)), (Names{"gnss", "wheels"}));
}

TEST_F(FaultyLog, AGapOfOneCameraTakesItsMasksAlong) {
  faults_.image_gap = {1, 2, 3};
  const Log log = RecordWith(faults_);

  EXPECT_EQ(Differences(clean_, log), (Names{"cam1", "mask1"}));
  EXPECT_EQ(log.streams.at("cam1").size(), 90u);
  EXPECT_EQ(log.streams.at("mask1").size(), 90u);
}

TEST_F(FaultyLog, AGapOfAllCamerasLeavesTheSensors) {
  faults_.image_gap = {-1, 2, 3};
  EXPECT_EQ(Differences(clean_, RecordWith(faults_)), (Names{"cam0", "cam1", "mask0", "mask1"}));
}

TEST_F(FaultyLog, ATimeOffsetMovesStampsOfItsCameraAndKeepsTheImages) {
  faults_.time_offsets = {0, 0.02};
  const Log log = RecordWith(faults_);

  EXPECT_EQ(Differences(clean_, log), (Names{"cam1", "mask1"}));
  for (size_t i = 0; i < 100; ++i) {
    EXPECT_EQ(log.streams.at("cam1")[i].content, clean_.streams.at("cam1")[i].content);
    // t_imu = stamp + offset.
    EXPECT_EQ(log.streams.at("cam1")[i].ms + 20, clean_.streams.at("cam1")[i].ms);
  }
}

TEST_F(FaultyLog, ATimeJumpGoesBackAndComesBack) {
  faults_.time_jump = {"imu", 5, 6, -0.5};
  const Log log = RecordWith(faults_);

  EXPECT_EQ(Differences(clean_, log), Names{"imu"});
  EXPECT_EQ(log.counts.at("time_jump.imu"), 100u);
  const std::vector<Entry>& imu = log.streams.at("imu");
  EXPECT_EQ(imu[500].ms, 4500);
  EXPECT_EQ(imu[600].ms, 6000);
}

TEST_F(FaultyLog, DuplicatesAreWrittenTwiceAndNothingIsLost) {
  faults_.duplicates = 0.1;
  const Log log = RecordWith(faults_);

  for (const char* stream : {"imu", "wheels", "gnss", "cam0", "cam1"}) {
    std::vector<Entry> entries = log.streams.at(stream);
    EXPECT_EQ(entries.size(), clean_.streams.at(stream).size() +
                                  log.counts.at(std::string("duplicates.") + stream));
    entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
    EXPECT_EQ(entries, clean_.streams.at(stream));
  }
  EXPECT_NEAR(static_cast<double>(log.counts.at("duplicates.imu")), 100, 40);
}

TEST_F(FaultyLog, UnorderedRecordsComeLateButCome) {
  faults_.unordered = 0.1;
  const Log log = RecordWith(faults_);

  std::vector<Entry> imu = log.streams.at("imu");
  const auto is_earlier = [](const Entry& a, const Entry& b) { return a.ms < b.ms; };
  EXPECT_FALSE(std::is_sorted(imu.begin(), imu.end(), is_earlier));
  std::sort(imu.begin(), imu.end(), is_earlier);
  EXPECT_EQ(imu, clean_.streams.at("imu"));
  EXPECT_EQ(log.streams.at("cam1").size(), 100u);
}

TEST_F(FaultyLog, CorruptImagesKeepTheirStampsAndOthersTheirBytes) {
  faults_.corrupt_jpegs = 0.2;
  const Log log = RecordWith(faults_);

  size_t num_different = 0;
  for (const char* camera : {"cam0", "cam1"}) {
    for (size_t i = 0; i < 100; ++i) {
      const Entry &damaged = log.streams.at(camera)[i], &clean = clean_.streams.at(camera)[i];
      EXPECT_EQ(damaged.ms, clean.ms);
      num_different += damaged.content != clean.content;
    }
  }
  EXPECT_EQ(num_different, log.counts.at("corrupt_jpegs"));
  EXPECT_GT(num_different, 20u);
  EXPECT_EQ(log.streams.at("mask0"), clean_.streams.at("mask0"));
  EXPECT_EQ(log.streams.at("imu"), clean_.streams.at("imu"));
}

TEST_F(FaultyLog, OneFaultLeavesTheOthersWhereTheyAre) {
  faults_.duplicates = 0.05;
  const Log before = RecordWith(faults_);
  faults_.imu_gap = {2, 3};
  faults_.corrupt_jpegs = 0;
  const Log after = RecordWith(faults_);

  EXPECT_EQ(Differences(before, after), Names{"imu"});
}

TEST(FaultOptions, NonsenseIsRefused) {
  const auto refuses = [](const std::function<void(FaultOptions&)>& spoil) {
    FaultOptions faults;
    spoil(faults);
    EXPECT_THROW(faults.Validate(), Error);
  };
  refuses([](FaultOptions& faults) { faults.imu_gap = {5, 4}; });
  refuses([](FaultOptions& faults) { faults.occlusion.kind = "snow"; });
  refuses([](FaultOptions& faults) { faults.time_jump.stream = "lidar"; });
  refuses([](FaultOptions& faults) { faults.extrinsic_rotation_deg = {0, 0, 0, 0, 1}; });
  refuses([](FaultOptions& faults) { faults.duplicates = 1; });
  EXPECT_NO_THROW(FaultOptions{}.Validate());
}

TEST(FaultOptions, ListsOfCamerasHaveOneNumberForAllOrOneForEach) {
  EXPECT_EQ(OfCamera({}, 2), 0);
  EXPECT_EQ(OfCamera({3}, 2), 3);
  EXPECT_EQ(OfCamera({1, 2}, 1), 2);
  EXPECT_EQ(OfCamera({1, 2}, 2), 0);
}

}  // namespace
}  // namespace parkade::simulator
