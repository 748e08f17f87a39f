#include "server/pipeline/progress.h"

#include <sys/resource.h>

#include <algorithm>
#include <cassert>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

namespace parkade {
namespace {

double SecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Resources that this process used, the workers of core/parallel included.
rusage Usage() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage;
}

/// Processor time so far [s].
double ProcessorSeconds() {
  const rusage usage = Usage();
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

}  // namespace

std::int64_t PeakMemoryBytes() {
  return std::int64_t{1024} * Usage().ru_maxrss;  // Linux counts KiB
}

Progress::Progress(std::vector<StagePlan> plan, const Outputs& outputs)
    : plan_(std::move(plan)), outputs_(outputs) {}

Progress::~Progress() {
  if (outputs_.terminal && (has_begun_ || !timings_.empty())) std::fputs("\r\033[K", stderr);
}

void Progress::Begin(const std::string& stage) {
  EndStage();
  const auto found = std::find_if(plan_.begin(), plan_.end(),
                                  [&](const StagePlan& planned) { return planned.name == stage; });
  assert(found != plan_.end());
  current_ = static_cast<size_t>(found - plan_.begin());
  has_begun_ = true;
  fraction_ = 0;
  stage_start_ = Clock::now();
  processor_start_ = ProcessorSeconds();
  Send(/*is_forced=*/true);
}

void Progress::Update(double fraction) {
  fraction_ = std::clamp(fraction, fraction_, 1.0);
  Send(/*is_forced=*/false);
}

void Progress::Finish() {
  EndStage();
  fraction_ = 1;
  Send(/*is_forced=*/true);
}

void Progress::Fail(const std::string& sentence, const std::string& code) {
  constexpr std::size_t kMaxBytes = 4096;
  // A sentence may quote a file name that is not UTF-8. A full disk may have cut the line before.
  Append('\n' + nlohmann::json{{"error", sentence.substr(0, kMaxBytes)}, {"code", code}}.dump(
                    -1, ' ', false, nlohmann::json::error_handler_t::replace));
}

double Progress::Overall() const {
  double done = 0, total = 0;
  for (size_t i = 0; i < plan_.size(); ++i) {
    total += plan_[i].weight;
    if (i < current_) done += plan_[i].weight;
  }
  return (done + fraction_ * plan_[current_].weight) / total;
}

void Progress::Send(bool is_forced) {
  const Clock::time_point now = Clock::now();
  if (!is_forced && now - last_sent_ < std::chrono::milliseconds(100)) return;
  last_sent_ = now;

  const double overall = Overall();
  const double elapsed = SecondsSince(start_);
  const std::string& stage = plan_[current_].name;
  nlohmann::json line{{"stage", stage}, {"progress", overall}};
  // An ETA from the first percent is a guess that helps no one.
  const bool has_eta = overall > 0.02 && elapsed > 1;
  const double eta = has_eta ? elapsed * (1 - overall) / overall : 0;
  if (has_eta) line["eta"] = eta;
  Append(line.dump());
  if (outputs_.terminal) {
    std::fprintf(stderr, "\r\033[K%3.0f %%  %s", 100 * overall, stage.c_str());
    if (has_eta) std::fprintf(stderr, "  %.0f s left", eta);
    std::fflush(stderr);
  }
}

void Progress::Append(const std::string& line) {
  if (!outputs_.file) return;
  // Progress is a courtesy: a full disk must not fail the job here.
  std::ofstream(*outputs_.file, std::ios::app) << line << '\n';
}

void Progress::EndStage() {
  if (!has_begun_) return;
  has_begun_ = false;
  timings_.push_back({plan_[current_].name, SecondsSince(stage_start_),
                      ProcessorSeconds() - processor_start_, PeakMemoryBytes()});
}

}  // namespace parkade
