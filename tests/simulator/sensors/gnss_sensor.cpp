#include "tests/simulator/sensors/gnss_sensor.h"

#include <algorithm>
#include <cmath>

#include "tests/simulator/common/drive_clock.h"
#include "tests/simulator/common/random.h"

namespace parkade::simulator {
namespace {

constexpr double kRate = 5;                    // [Hz]
constexpr double kUsualSigma[] = {1.5, 0.02};  // [m] standard, RTK
constexpr double kAcquisition = 3;             // [s] of open sky before the first fix
constexpr double kSettling = 8;                // [s] until sigma is as usual

Eigen::Vector3d NormalVector(Random& random) {
  const double x = random.Normal(), y = random.Normal(), z = random.Normal();
  return {x, y, z};
}

/// How much worse than under an open sky a receiver is that has seen the sky for `seconds`.
double SigmaFactor(double hidden_sky, double seconds, bool has_been_covered) {
  const double settling =
      has_been_covered ? 3 * std::exp(-(seconds - kAcquisition) / kSettling) : 0;
  return 1 + 6 * hidden_sky + settling;
}

}  // namespace

double HiddenSky(const RoofQuery& is_covered, const Eigen::Vector3d& point) {
  constexpr int kDirections = 8;
  if (!is_covered) return 0;
  if (is_covered(point)) return 1;
  int num_covered = 0;
  for (const double radius : {3.0, 6.0, 10.0}) {
    for (int i = 0; i < kDirections; ++i) {
      const double azimuth = 2 * M_PI * i / kDirections;
      num_covered +=
          is_covered(point + radius * Eigen::Vector3d(std::cos(azimuth), std::sin(azimuth), 0));
    }
  }
  return num_covered / (3.0 * kDirections);
}

std::vector<MultipathJump> PlanMultipath(double duration, const SensorOptions& options,
                                         std::uint64_t seed) {
  std::vector<MultipathJump> jumps;
  if (options.gnss != "standard" || options.gnss_multipath == 0) return jumps;
  Random random(seed, 0x6f);
  double time = 0;
  while (true) {
    time += -std::log(1 - random.Uniform()) * 60 / options.gnss_multipath;
    if (time >= duration) return jumps;
    const double azimuth = random.Uniform(0, 2 * M_PI), size = random.Uniform(2, 7),
                 length = random.Uniform(2, 10);
    jumps.push_back(
        {time, time + length, size * Eigen::Vector3d(std::cos(azimuth), std::sin(azimuth), 1.2)});
    time += length;
  }
}

std::vector<GnssFix> SimulateGnss(const Motion& motion, const Rig& rig, const SiteDatum& datum,
                                  const SensorOptions& options, std::uint64_t seed,
                                  const RoofQuery& is_covered) {
  std::vector<GnssFix> fixes;
  if (options.gnss == "none") return fixes;
  Random random(seed, 0x6e);
  const bool is_rtk = options.gnss == "rtk";
  const double sigma = options.gnss_sigma > 0 ? options.gnss_sigma : kUsualSigma[is_rtk];
  const std::vector<MultipathJump> jumps = PlanMultipath(motion.Duration(), options, seed);
  const double slow_share = is_rtk ? 0.6 : 0.98,
               white_share = std::sqrt(1 - slow_share * slow_share);
  const double keep = std::exp(-1 / (options.gnss_memory * kRate));
  Eigen::Vector3d slow = NormalVector(random);
  double open_since = -kAcquisition;  // a receiver that was on before the drive
  bool has_been_covered = false;
  for (const Timestamp time : Ticks(motion.Duration(), kRate, 0.0631, seed)) {
    const double seconds = time - DriveEpoch(seed);
    slow = keep * slow + std::sqrt(1 - keep * keep) * NormalVector(random);
    const Eigen::Vector3d white = NormalVector(random);
    const Eigen::Vector3d antenna = motion.WorldFromBody(seconds) * *rig.vehicle->antenna_in_body;
    const double hidden = HiddenSky(is_covered, antenna);
    if (hidden >= 1) {
      has_been_covered = true;
      open_since = seconds;
    }
    if (seconds - open_since < kAcquisition) continue;
    const double factor = SigmaFactor(hidden, seconds - open_since, has_been_covered);
    const Eigen::Vector3d sigmas = factor * sigma * Eigen::Vector3d(1, 1, 1.8);
    Eigen::Vector3d error = sigmas.cwiseProduct(slow_share * slow + white_share * white);
    for (const MultipathJump& jump : jumps)
      if (jump.begin <= seconds && seconds < jump.end) error += jump.offset;
    const Geodetic place = GeodeticFromSite(datum, antenna + error);
    fixes.push_back({time, place.latitude_deg, place.longitude_deg, place.altitude, sigmas});
  }
  return fixes;
}

}  // namespace parkade::simulator
