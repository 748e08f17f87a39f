#include "server/ingest/drive/coverage_findings.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

constexpr Timestamp kBegin{1'700'000'000'000'000'000};

/// An IMU, wheels and two cameras that cover a minute, of which tests take something away.
struct Drive {
  std::vector<SensorStream> streams;
  std::vector<StreamHealth> health;

  Drive() {
    for (const StreamKind kind :
         {StreamKind::kImu, StreamKind::kWheels, StreamKind::kImage, StreamKind::kImage}) {
      SensorStream stream;
      stream.kind = kind;
      stream.topic_name = "/" + std::to_string(streams.size());
      streams.push_back(stream);
      StreamHealth covered;
      covered.span = {kBegin, kBegin + 60.0};
      health.push_back(covered);
    }
  }

  /// The names of what is found.
  std::string Names() const {
    std::string names;
    for (const Finding& finding : FindUncovered(streams, health))
      names += finding.name + " of " + finding.topic + ", " + NameOf(finding.severity) + "; ";
    return names;
  }
};

TEST(FindUncovered, SaysNothingWhereAllIsThere) {
  Drive drive;
  drive.health[0].span = {kBegin + 0.8, kBegin + 59.5};
  drive.health[1].span = {kBegin + 3.0, kBegin + 58.0};
  EXPECT_EQ(drive.Names(), "");
}

TEST(FindUncovered, KnowsAnImuThatEndsEarlyOrBeginsLate) {
  Drive drive;
  drive.health[0].span = {kBegin + 2.0, kBegin + 50.0};
  EXPECT_EQ(drive.Names(), "imu_begins_late of /0, warning; imu_ends_early of /0, warning; ");
}

TEST(FindUncovered, TakesStuckReadingsForNone) {
  Drive drive;
  drive.streams[0].stuck = {{kBegin + 40.0, kBegin + 60.0}};
  EXPECT_EQ(drive.Names(), "imu_ends_early of /0, warning; ");
}

TEST(FindUncovered, KnowsACameraWithHardlyAnyImages) {
  Drive drive;
  drive.health[2].num_delivered = 300;
  drive.health[3].num_delivered = 60;
  EXPECT_EQ(drive.Names(), "camera_slow of /3, warning; ");
}

TEST(FindUncovered, KnowsGapsOfTheImu) {
  Drive drive;
  drive.health[0].longest_gap = 0.5;
  drive.health[0].longest_gap_begin = kBegin + 10.0;
  EXPECT_EQ(drive.Names(), "imu_gap of /0, note; ");
  drive.health[0].longest_gap = 1.5;
  EXPECT_EQ(drive.Names(), "imu_gap of /0, warning; ");
}

TEST(FindUncovered, KnowsWheelsAndCamerasThatAreMissingForATenth) {
  Drive drive;
  drive.health[1].span.end = kBegin + 50.0;
  drive.health[3].span.begin = kBegin + 10.0;
  EXPECT_EQ(drive.Names(),
            "stream_covers_part of /1, warning; stream_covers_part of /3, warning; ");
}

}  // namespace
}  // namespace parkade
