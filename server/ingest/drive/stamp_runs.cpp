#include "server/ingest/drive/stamp_runs.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.h"
#include "core/math/statistics.h"
#include "server/ingest/messages/sensor_decoding.h"

namespace parkade {
namespace {

constexpr double kMaxStep = 2;         // [s] between messages; a longer one may be a leap
constexpr double kMaxBackStep = 0.5;   // [s] backward, alike
constexpr double kMinBackStep = 0.1;   // [s] from here on, where the recorder's clock shows it, too
constexpr std::size_t kLags = 10;      // messages whose delay in the log is looked at
constexpr double kWindow = 3;          // [s] after a step in which the delay has to stay
constexpr std::size_t kMinRun = 5;     // messages; fewer are a glitch
constexpr double kGapTolerance = 0.5;  // [s]

bool IsLeap(double step) { return step > kMaxStep || step < -kMaxBackStep; }

/// From the stamps of messages to when they were recorded.
struct Lag {
  double median = 0, deviation = 0;  ///< [s]
};

Lag LagOf(const StampSequence& sequence, std::size_t begin, std::size_t end) {
  std::vector<double> lags, deviations;
  for (std::size_t i = begin; i < end; ++i)
    lags.push_back(sequence.log_times[i] - sequence.stamps[i]);
  const double median = Median(lags);
  for (const double lag : lags) deviations.push_back(std::abs(lag - median));
  return {median, Median(deviations)};
}

/// Whether the clock was set a little back before a message. Messages that come late go back, too,
/// but those behind them do not.
bool IsSetBack(const StampSequence& sequence, std::size_t i) {
  const double step = sequence.StepAt(i);
  if (step > -kMinBackStep || i < kLags) return false;
  std::size_t end = i + 1;
  while (end < sequence.stamps.size() && sequence.log_times[end] - sequence.log_times[i] < kWindow)
    ++end;
  if (end < i + 2 * kLags) return false;
  const Lag before = LagOf(sequence, i - kLags, i), after = LagOf(sequence, end - kLags, end);
  const double set_back = sequence.log_times[i] - sequence.log_times[i - 1] - step;
  return std::abs((after.median - before.median) / set_back - 1) < 0.3 &&
         std::max(before.deviation, after.deviation) < -0.2 * step;
}

/// The log time where the message is damaged or its stamp is none.
Timestamp StampOrLogTime(const RawMessage& message, const SensorStream& stream) {
  constexpr std::int64_t kLatest = 4'300'000'000'000'000'000;
  try {
    const Timestamp stamp = StampOf(message, stream.encoding, stream.type);
    return stamp.ns >= 0 && stamp.ns < kLatest ? stamp : message.log_time;
  } catch (const Error&) {
    return message.log_time;
  }
}

}  // namespace

double StampSequence::Period() const {
  std::vector<double> steps;
  for (std::size_t i = 1; i < stamps.size(); ++i)
    if (StepAt(i) > 0 && !IsLeap(StepAt(i))) steps.push_back(StepAt(i));
  return steps.empty() ? 0.1 : Median(steps);
}

std::vector<StampSequence> ReadStamps(const MessageSource& source,
                                      const std::vector<SensorStream>& streams) {
  std::vector<bool> wanted(source.topics().size(), false);
  std::vector<std::size_t> stream_of_topic(wanted.size(), 0);
  for (std::size_t i = 0; i < streams.size(); ++i) {
    wanted[static_cast<std::size_t>(streams[i].topic)] = true;
    stream_of_topic[static_cast<std::size_t>(streams[i].topic)] = i;
  }
  std::vector<StampSequence> sequences(streams.size());
  const auto messages = source.Read(wanted);
  for (std::uint64_t order = 0; const std::optional<RawMessage> message = messages->Next();
       ++order) {
    const std::size_t i = stream_of_topic[static_cast<std::size_t>(message->topic)];
    sequences[i].stamps.push_back(StampOrLogTime(*message, streams[i]));
    sequences[i].log_times.push_back(message->log_time);
    sequences[i].orders.push_back(order);
  }
  return sequences;
}

std::vector<StampRun> RunsOf(const StampSequence& sequence) {
  std::vector<StampRun> all;
  for (std::size_t i = 0; i < sequence.stamps.size(); ++i) {
    if (i == 0 || IsLeap(sequence.StepAt(i)) || IsSetBack(sequence, i)) all.push_back({i, i});
    all.back().end = i + 1;
  }
  std::vector<StampRun> runs;
  for (const StampRun& run : all) {
    if (run.size() < kMinRun) continue;
    const double step =
        runs.empty() ? 0 : sequence.stamps[run.begin] - sequence.stamps[runs.back().end - 1];
    if (!runs.empty() && step > -kMinBackStep && !IsLeap(step))
      runs.back().end = run.end;
    else
      runs.push_back(run);
  }
  return runs;
}

bool ClockLeap::IsGap() const { return step > 0 && std::abs(step - log_step) < kGapTolerance; }

double ClockLeap::Correction(double period) const {
  const bool was_waiting = log_step > std::max(0.15, 5 * period) && log_step < 3600;
  const double expected = was_waiting ? period * std::round(log_step / period) : period;
  return expected - step;
}

ClockLeap LeapBetween(const StampSequence& sequence, const StampRun& a, const StampRun& b) {
  const std::size_t before = a.end - 1, after = b.begin;
  return {before, after, sequence.stamps[after] - sequence.stamps[before],
          sequence.log_times[after] - sequence.log_times[before]};
}

}  // namespace parkade
