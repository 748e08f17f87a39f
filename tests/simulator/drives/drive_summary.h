#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/simulator/drives/plan_drive.h"
#include "tests/simulator/drives/simulate_options.h"

namespace parkade::simulator {

/// Changes whenever the same options give other bytes than before.
inline constexpr int kSimulatorVersion = 11;

/// 16 hex digits of all options and the simulator's version: drives are cached by it. FNV-1a, 64
/// bits.
std::string HashOf(const SimulateOptions& options);

/// What was written, for summary.json.
struct DriveCounts {
  size_t images = 0, image_bytes = 0;
  size_t imu = 0, wheels = 0,
         gnss = 0;  ///< as the sensors gave them, before the faults of the recorder
  std::map<std::string, size_t> faults;  ///< records that each fault has met
};

/// Everything of summary.json but the timings.
nlohmann::json SummaryOf(const SimulateOptions& options, const DrivePlan& plan,
                         const DriveCounts& counts);

}  // namespace parkade::simulator
