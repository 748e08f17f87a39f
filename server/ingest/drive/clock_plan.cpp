#include "server/ingest/drive/clock_plan.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "core/error.h"
#include "core/math/statistics.h"
#include "server/ingest/messages/sensor_decoding.h"

namespace parkade {
namespace {

constexpr double kWindow = 3;  // [s] of the log around a leap in which other streams follow it
constexpr std::uint64_t kMinStretch = 300;  // samples of the IMU; less is no drive

/// Plans the clocks of one log.
class Planner {
 public:
  Planner(const std::vector<SensorStream>& streams, const std::vector<StampSequence>& sequences)
      : streams_(streams), sequences_(sequences) {
    plan_.runs.resize(streams.size());
    for (const StampSequence& sequence : sequences) {
      runs_.push_back(RunsOf(sequence));
      periods_.push_back(sequence.Period());
    }
  }

  ClockPlan Plan() {
    FindCommonLeaps();
    for (std::size_t i = 0; i < streams_.size(); ++i) PlanStream(i);
    DropShortStretches();
    return std::move(plan_);
  }

 private:
  struct CommonLeap {
    std::uint64_t order = 0;  ///< of the IMU's first message behind it
    double step = 0;          ///< [s]
  };

  /// Whether a step of a stream is a leap of the IMU's clock that it takes part in.
  bool IsAlike(double step, std::size_t stream, double imu_step) const {
    const double tolerance = std::min(1 + periods_[stream], 0.3 * std::abs(imu_step));
    return std::abs((step - periods_[stream]) - (imu_step - periods_[0])) < tolerance;
  }

  /// Whether a stream leaps about as far as the IMU does, at about the same place of the log;
  /// nothing where it is not there on both sides.
  std::optional<bool> Follows(std::size_t stream, const ClockLeap& imu) const {
    const StampSequence& sequence = sequences_[stream];
    const std::uint64_t order = sequences_[0].orders[imu.after];
    const auto at = std::lower_bound(sequence.orders.begin(), sequence.orders.end(), order);
    const auto middle = static_cast<std::size_t>(at - sequence.orders.begin());
    if (middle == 0 || middle == sequence.orders.size()) return std::nullopt;
    const auto reach = static_cast<std::size_t>(std::ceil(kWindow / periods_[stream])) + 1;
    for (std::size_t i = std::max<std::size_t>(1, middle - std::min(middle, reach));
         i < std::min(middle + reach, sequence.stamps.size()); ++i)
      if (IsAlike(sequence.StepAt(i), stream, imu.step)) return true;
    return false;
  }

  void FindCommonLeaps() {
    for (std::size_t k = 1; k < runs_[0].size(); ++k) {
      const ClockLeap leap = LeapBetween(sequences_[0], runs_[0][k - 1], runs_[0][k]);
      int num_following = 0, num_steady = 0;
      for (std::size_t i = 1; i < streams_.size(); ++i) {
        const std::optional<bool> follows = Follows(i, leap);
        if (follows) ++(*follows ? num_following : num_steady);
      }
      const bool is_gap = leap.IsGap();
      if (num_following < num_steady || (num_following == 0 && num_steady == 0 && !is_gap))
        continue;
      leaps_.push_back({sequences_[0].orders[leap.after], leap.step});
      plan_.num_stretches = static_cast<int>(leaps_.size()) + 1;
      Report(leap, is_gap);
    }
  }

  void Report(const ClockLeap& leap, bool is_gap) {
    const double since =
        sequences_[0].stamps[leap.before] - sequences_[0].stamps[runs_[0][0].begin];
    char at[40];
    std::snprintf(at, sizeof(at), "%.1f s", since);
    const std::string what = is_gap ? "nothing is recorded for " + DurationText(leap.step) +
                                          " after " + at + ", or all clocks were set by as much"
                                    : "all clocks leap by " + DurationText(leap.step) +
                                          (leap.step < 0 ? " back" : " ahead") + " after " + at;
    plan_.findings.push_back(
        {is_gap ? "recording_pauses" : "clocks_leap",
         Severity::kWarning,
         "",
         what + ": what comes before and behind is mapped as drives of their own",
         is_gap ? "" : "keep the recorder's clock from being set while it records",
         {{"leap_s", leap.step}, {"after_s", since}}});
  }

  /// The stretch that a message behind `order` lies in, where its own stream does not say.
  int StretchAt(std::uint64_t order) const {
    int stretch = 0;
    for (const CommonLeap& leap : leaps_) stretch += order >= leap.order ? 1 : 0;
    return stretch;
  }

  void PlanStream(std::size_t stream) {
    const StampSequence& sequence = sequences_[stream];
    std::vector<ClockRun>& planned = plan_.runs[stream];
    int stretch = 0;
    double correction = 0;
    for (std::size_t k = 0; k < runs_[stream].size(); ++k) {
      const StampRun& run = runs_[stream][k];
      if (k == 0) {
        stretch = StretchAt(sequence.orders[run.begin]);
      } else {
        const ClockLeap leap = LeapBetween(sequence, runs_[stream][k - 1], run);
        const int next = NextStretch(leap, stretch, stream);
        if (next != stretch) {
          stretch = next;
          correction = 0;
        } else if (!leap.IsGap()) {
          correction += leap.Correction(periods_[stream]);
          ReportStep(stream, leap);
        }
      }
      planned.push_back({run.begin, correction, stretch});
    }
    if (planned.empty()) planned.push_back({0, 0, 0});
    planned.front().begin = 0;
    // A stream that leaps nowhere still lies in stretches.
    if (leaps_.size() + 1 > planned.size()) SplitAtLeaps(sequence, planned);
  }

  /// The stretch behind a leap of a stream, which lies in `stretch`: the next one whose leap is as
  /// large; the same where the stream leaps alone.
  int NextStretch(const ClockLeap& leap, int stretch, std::size_t stream) const {
    for (std::size_t i = static_cast<std::size_t>(stretch); i < leaps_.size(); ++i)
      if (IsAlike(leap.step, stream, leaps_[i].step)) return static_cast<int>(i) + 1;
    return stretch;
  }

  void SplitAtLeaps(const StampSequence& sequence, std::vector<ClockRun>& planned) const {
    for (std::size_t i = 0; i < leaps_.size(); ++i) {
      const int stretch = static_cast<int>(i) + 1;
      if (std::any_of(planned.begin(), planned.end(),
                      [&](const ClockRun& run) { return run.stretch == stretch; }))
        continue;
      const auto at =
          std::lower_bound(sequence.orders.begin(), sequence.orders.end(), leaps_[i].order);
      const auto begin = static_cast<std::uint64_t>(at - sequence.orders.begin());
      const auto after = std::find_if(planned.begin(), planned.end(),
                                      [&](const ClockRun& run) { return run.begin >= begin; });
      const double correction = after == planned.begin() ? 0 : std::prev(after)->correction;
      planned.insert(after, {begin, correction, stretch});
    }
  }

  void ReportStep(std::size_t stream, const ClockLeap& leap) {
    const StampSequence& imu = sequences_[0];
    char at[40];
    std::snprintf(at, sizeof(at), "%.1f s",
                  sequences_[stream].stamps[leap.before] -
                      (imu.stamps.empty() ? sequences_[stream].stamps[0] : imu.stamps[0]));
    plan_.findings.push_back({"clock_steps",
                              Severity::kWarning,
                              streams_[stream].topic_name,
                              "the clock of " + streams_[stream].topic_name + " alone steps by " +
                                  DurationText(leap.step) + (leap.step < 0 ? " back" : " ahead") +
                                  " after " + at +
                                  ": its stamps are put back so that they go on as before",
                              "keep the sensor's clock from being set while it records",
                              {{"step_s", leap.step}}});
  }

  /// Stretches with few samples of the IMU are no drives.
  void DropShortStretches() {
    std::vector<std::uint64_t> sizes(static_cast<std::size_t>(plan_.num_stretches), 0);
    const std::vector<ClockRun>& imu = plan_.runs[0];
    for (std::size_t i = 0; i < imu.size(); ++i) {
      const std::uint64_t end = i + 1 < imu.size() ? imu[i + 1].begin : sequences_[0].stamps.size();
      if (imu[i].stretch >= 0)
        sizes[static_cast<std::size_t>(imu[i].stretch)] += end - imu[i].begin;
    }
    std::vector<int> renamed;
    int count = 0;
    const std::uint64_t largest = *std::max_element(sizes.begin(), sizes.end());
    for (const std::uint64_t size : sizes) {
      const bool is_drive = size >= std::min(kMinStretch, largest);
      renamed.push_back(is_drive ? count++ : -1);
      const double seconds = static_cast<double>(size) * periods_[0];
      if (!is_drive)
        plan_.findings.push_back({"stretch_too_short",
                                  Severity::kWarning,
                                  "",
                                  "a stretch of " + DurationText(seconds) +
                                      " between two leaps is too short to be mapped and left out",
                                  "",
                                  {{"seconds", seconds}}});
    }
    plan_.num_stretches = count;
    for (std::vector<ClockRun>& runs : plan_.runs)
      for (ClockRun& run : runs)
        run.stretch = run.stretch < 0 ? -1 : renamed[static_cast<std::size_t>(run.stretch)];
  }

  const std::vector<SensorStream>& streams_;
  const std::vector<StampSequence>& sequences_;
  std::vector<std::vector<StampRun>> runs_;
  std::vector<double> periods_;  ///< [s]
  std::vector<CommonLeap> leaps_;
  ClockPlan plan_;
};

}  // namespace

ClockPlan PlanClocks(const std::vector<SensorStream>& streams,
                     const std::vector<StampSequence>& sequences) {
  if (streams.empty() || sequences[0].stamps.empty()) return {};
  return Planner(streams, sequences).Plan();
}

}  // namespace parkade
