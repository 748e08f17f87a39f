#include "server/ingest/drive/clock_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

namespace parkade {
namespace {

constexpr std::int64_t kBegin = 1'700'000'000'000'000'000;

/// A stream with a message every `period` seconds for 20 s.
struct Stream {
  double period = 0.1;
  double latency = 0;  ///< [s] until a message is in the log
  /// The stamp that a message gets, instead of the true time since the beginning [s].
  std::function<double(double)> stamp = [](double time) { return time; };
};

struct Log {
  std::vector<SensorStream> streams;
  std::vector<StampSequence> sequences;
};

/// `clock` gives the recorder's time.
Log MakeLog(
    const std::vector<Stream>& wanted,
    const std::function<double(double)>& clock = [](double time) { return time; }) {
  struct Message {
    double logged = 0, time = 0;
    size_t stream = 0;
  };
  std::vector<Message> messages;
  for (size_t i = 0; i < wanted.size(); ++i)
    for (double t = 0; t < 20; t += wanted[i].period)
      messages.push_back({t + wanted[i].latency, t, i});
  std::stable_sort(messages.begin(), messages.end(),
                   [](const Message& a, const Message& b) { return a.logged < b.logged; });
  Log log;
  log.streams.resize(wanted.size());
  log.sequences.resize(wanted.size());
  for (size_t i = 0; i < wanted.size(); ++i) log.streams[i].topic_name = "/" + std::to_string(i);
  for (size_t order = 0; order < messages.size(); ++order) {
    const Message& message = messages[order];
    StampSequence& sequence = log.sequences[message.stream];
    sequence.stamps.push_back(Timestamp{kBegin} + wanted[message.stream].stamp(message.time));
    sequence.log_times.push_back(Timestamp{kBegin} + clock(message.logged));
    sequence.orders.push_back(order);
  }
  return log;
}

ClockPlan Plan(const Log& log) { return PlanClocks(log.streams, log.sequences); }

/// The stamp of a message on the plan's clock [s], and the stretch that it lies in.
std::pair<double, int> Planned(const Log& log, const ClockPlan& plan, size_t stream,
                               size_t message) {
  ClockRun run;
  for (const ClockRun& candidate : plan.runs[stream])
    if (candidate.begin <= message) run = candidate;
  return {log.sequences[stream].stamps[message] - Timestamp{kBegin} + run.correction, run.stretch};
}

constexpr double kLeap = 7.995;  // [s] between messages of all streams

double LeapAt8(double time, double leap) { return time < kLeap ? time : time + leap; }

TEST(ClockPlan, LeavesAGoodLogAlone) {
  const ClockPlan plan = Plan(MakeLog({{0.01}, {0.1, 0.08}, {0.02}, {1}}));
  EXPECT_TRUE(plan.findings.empty());
  EXPECT_EQ(plan.num_stretches, 1);
}

TEST(ClockPlan, CutsWhereAllClocksLeap) {
  for (const double leap : {10.0, 600.0, 3600.0, -3600.0, 1.7e9 - 100, -5.0}) {
    const auto stamp = [=](double time) { return LeapAt8(time, leap); };
    const Log log =
        MakeLog({{0.01, 0, stamp}, {0.1, 0.08, stamp}, {0.02, 0, stamp}, {1, 0.1, stamp}}, stamp);
    const ClockPlan plan = Plan(log);
    ASSERT_EQ(plan.num_stretches, 2) << leap;
    ASSERT_EQ(plan.findings.size(), 1u) << leap;
    for (size_t i = 0; i < log.streams.size(); ++i)
      for (size_t k = 0; k < log.sequences[i].stamps.size(); ++k) {
        const double time = static_cast<double>(k) * std::vector{0.01, 0.1, 0.02, 1.0}[i];
        EXPECT_EQ(Planned(log, plan, i, k).second, time < kLeap ? 0 : 1)
            << leap << " stream " << i << " at " << time;
      }
  }
}

TEST(ClockPlan, CutsWhereTheRecordingPauses) {
  // Nothing is in the log between 8 and 12 s.
  const auto clock = [](double time) { return LeapAt8(time, 40); };
  const ClockPlan plan = Plan(MakeLog({{0.01, 0, clock}, {0.1, 0, clock}}, clock));
  ASSERT_EQ(plan.findings.size(), 1u);
  EXPECT_EQ(plan.findings[0].name, "recording_pauses");
  EXPECT_EQ(plan.num_stretches, 2);
}

TEST(ClockPlan, PutsAClockBackThatStepsAlone) {
  for (const double step : {-3600.0, 7200.0, -2.5, -0.4}) {
    const auto stamp = [=](double time) { return LeapAt8(time, step); };
    for (const size_t stream : {0, 1}) {
      std::vector<Stream> streams = {{0.01}, {0.1, 0.08}, {0.1, 0.03}, {0.02}};
      streams[stream].stamp = stamp;
      const Log log = MakeLog(streams);
      const ClockPlan plan = Plan(log);
      EXPECT_EQ(plan.num_stretches, 1) << step << " " << stream;
      ASSERT_EQ(plan.findings.size(), 1u) << step << " " << stream;
      EXPECT_EQ(plan.findings[0].name, "clock_steps");
      EXPECT_EQ(plan.findings[0].topic, "/" + std::to_string(stream));
      for (size_t k = 0; k < log.sequences[stream].stamps.size(); ++k)
        EXPECT_NEAR(Planned(log, plan, stream, k).first,
                    static_cast<double>(k) * streams[stream].period, 1e-6);
    }
  }
}

TEST(ClockPlan, LeavesAGapOfOneCameraAlone) {
  Log log = MakeLog({{0.01}, {0.1, 0.08}, {0.1, 0.03}});
  StampSequence& camera = log.sequences[1];
  for (auto* times : {&camera.stamps, &camera.log_times})
    times->erase(times->begin() + 80, times->begin() + 130);
  camera.orders.erase(camera.orders.begin() + 80, camera.orders.begin() + 130);
  const ClockPlan plan = Plan(log);
  EXPECT_TRUE(plan.findings.empty());
  EXPECT_NEAR(Planned(log, plan, 1, 100).first, 15, 1e-6);
}

TEST(ClockPlan, BelievesNoGlitch) {
  const auto glitch = [](double time) { return time > 8 && time < 8.035 ? time + 500 : time; };
  const Log log = MakeLog({{0.01, 0, glitch}, {0.1, 0.08}, {0.1, 0.03}});
  const ClockPlan plan = Plan(log);
  EXPECT_TRUE(plan.findings.empty());
  EXPECT_EQ(plan.num_stretches, 1);
}

}  // namespace
}  // namespace parkade
