#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace parkade {

/// Share of the whole run that a stage is expected to take.
struct StagePlan {
  std::string name;
  double weight = 1;
};

/// How long one stage took.
struct StageTiming {
  std::string name;
  double seconds = 0;
  double processor_seconds = 0;        ///< of all threads
  std::int64_t peak_memory_bytes = 0;  ///< of the process, until its end
};

/// Processor time of this process so far, the workers of core/parallel included.
std::int64_t PeakMemoryBytes();

/// Tells people and the service how far a run is: a line with an ETA on a
/// terminal, and JSON lines {"stage", "progress", "eta"} in a file that the
/// service reads while the worker runs. One thread.
class Progress {
 public:
  struct Outputs {
    bool terminal = false;                      ///< redraw a line on stderr
    std::optional<std::filesystem::path> file;  ///< appended to, one JSON object per line
  };

  Progress(std::vector<StagePlan> plan, const Outputs& outputs);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Ends the current stage and begins the named one, which must be in the plan.
  void Begin(const std::string& stage);

  /// `fraction` of the current stage, 0-1. Cheap: at most ten lines a second go out.
  void Update(double fraction);

  /// Works on each of `items` in turn; each takes the same share of the current stage.
  template <typename Items, typename Work>
  void ForEach(Items& items, Work work) {
    double done = 0;
    for (auto& item : items) {
      work(item);
      Update(++done / static_cast<double>(items.size()));
    }
  }

  /// Ends the last stage.
  void Finish();

  /// Appends {"error", "code"}: the last line of a run that failed.
  void Fail(const std::string& sentence, const std::string& code);

  const std::vector<StageTiming>& timings() const { return timings_; }

 private:
  using Clock = std::chrono::steady_clock;

  double Overall() const;
  void Send(bool is_forced);
  void Append(const std::string& line);
  void EndStage();

  std::vector<StagePlan> plan_;
  Outputs outputs_;
  size_t current_ = 0;
  bool has_begun_ = false;
  double fraction_ = 0;
  Clock::time_point start_ = Clock::now();
  Clock::time_point stage_start_ = start_;
  double processor_start_ = 0;  ///< [s] of processor time
  Clock::time_point last_sent_{};
  std::vector<StageTiming> timings_;
};

}  // namespace parkade
