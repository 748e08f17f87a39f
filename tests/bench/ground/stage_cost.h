#pragma once

#include <atomic>
#include <string>
#include <thread>

namespace parkade {

/// What a stage took of the machine.
struct StageCost {
  std::string name;
  double processor_seconds = 0;
  double peak_mebibytes = 0;  ///< the most that was in memory at once, from the stage's begin on
  double peak_own_mebibytes = 0;  ///< the most that cannot be put aside into a file
};

/// Measures from its making on.
class StageMeter {
 public:
  explicit StageMeter(std::string name);
  ~StageMeter();
  StageMeter(const StageMeter&) = delete;
  StageMeter& operator=(const StageMeter&) = delete;

  StageCost Finish();

 private:
  std::string name_;
  double processor_start_;
  std::atomic<bool> is_over_ = false;
  double peak_own_ = 0;  // of the watching thread until it is over
  std::thread watch_;
};

}  // namespace parkade
