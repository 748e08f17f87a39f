#include "server/jobs/worker_watch.h"

#include <algorithm>
#include <cmath>

namespace parkade {
namespace {

/// [s] since the last sign of life. Timers of idle threads use less.
constexpr double kProcessorLife = 0.1;

}  // namespace

bool WorkerWatch::IsAlive(const GroupUsage& usage) const {
  // Either sum falls when a process of the group ends: that is a sign of life too.
  return usage.is_busy || usage.disk_bytes != at_life_.disk_bytes ||
         std::abs(usage.processor_seconds - at_life_.processor_seconds) >= kProcessorLife;
}

WorkerTrouble WorkerWatch::Look(const GroupUsage& usage, bool has_spoken, Clock::time_point now) {
  const Clock::duration passed = std::min<Clock::duration>(now - last_, std::chrono::seconds{1});
  last_ = now;
  silent_ = has_spoken ? Clock::duration{0} : silent_ + passed;
  if (has_spoken || IsAlive(usage)) {
    idle_ = Clock::duration{0};
    at_life_ = usage;
  } else {
    idle_ += passed;
  }
  if (limits_.memory_bytes > 0 && usage.memory_bytes > limits_.memory_bytes)
    return WorkerTrouble::kOverMemory;
  if (limits_.tasks > 0 && usage.tasks >= limits_.tasks) return WorkerTrouble::kOverTasks;
  if (now - start_ > limits_.time) return WorkerTrouble::kIsLate;
  if (idle_ >= limits_.hang) return WorkerTrouble::kHangs;
  return silent_ >= limits_.silence ? WorkerTrouble::kIsSilent : WorkerTrouble::kNone;
}

}  // namespace parkade
