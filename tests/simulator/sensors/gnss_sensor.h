#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/drive_log.h"
#include "core/geo.h"
#include "core/rig.h"
#include "tests/simulator/motion/motion.h"
#include "tests/simulator/sensors/sensor_options.h"

namespace parkade::simulator {

/// True where a roof is above a point of the world.
using RoofQuery = std::function<bool(const Eigen::Vector3d&)>;

/// Share of the sky, 0 to 1, that roofs hide from a point: 1 below a roof, less beside one.
double HiddenSky(const RoofQuery& is_covered, const Eigen::Vector3d& point);

/// A receiver under an open sky says what its errors are; a reflected signal is what it does not
/// know about.
struct MultipathJump {
  double begin = 0, end = 0;  ///< [s] of the drive
  Eigen::Vector3d offset;     ///< [m] in world
};
std::vector<MultipathJump> PlanMultipath(double duration, const SensorOptions& options,
                                         std::uint64_t seed);

/// Fixes at 5 Hz in order of time. Standard GNSS errs slowly (Gauss-Markov) and jumps at times, RTK
/// is exact to centimeters. Errors and the sigma that is told grow toward a roof; below it there
/// are no fixes, and for some seconds after it neither.
std::vector<GnssFix> SimulateGnss(const Motion& motion, const Rig& rig, const SiteDatum& datum,
                                  const SensorOptions& options, std::uint64_t seed,
                                  const RoofQuery& is_covered = {});

}  // namespace parkade::simulator
