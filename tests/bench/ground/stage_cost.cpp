#include "tests/bench/ground/stage_cost.h"

#include <malloc.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <fstream>

namespace parkade {
namespace {

double ProcessorSeconds() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// [MiB] of the line that begins with `name`.
double StatusOf(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with(name)) return std::stod(line.substr(name.size())) / 1024;
  return 0;
}

}  // namespace

StageMeter::StageMeter(std::string name)
    : name_(std::move(name)), processor_start_(ProcessorSeconds()) {
  ::malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";  // the peak begins anew
  watch_ = std::thread([this] {
    while (!is_over_) {
      peak_own_ = std::max(peak_own_, StatusOf("RssAnon:"));
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  });
}

StageMeter::~StageMeter() {
  is_over_ = true;
  if (watch_.joinable()) watch_.join();
}

StageCost StageMeter::Finish() {
  is_over_ = true;
  watch_.join();
  return {name_, ProcessorSeconds() - processor_start_, StatusOf("VmHWM:"), peak_own_};
}

}  // namespace parkade
