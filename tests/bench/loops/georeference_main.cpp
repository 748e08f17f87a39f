// How well GNSS puts a site of one drive or several on Earth, and whether the covariance that is
// reported is true, over many simulated keyframes without images. Trajectories are the truth, bent
// as odometry bends it; drives of a site are joined without error.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <numeric>
#include <random>

#include "core/options_json.h"
#include "core/yaw.h"
#include "slam/georeference/align_to_gnss.h"
#include "slam/sessions/place_by_gnss.h"
#include "tests/bench/odometry/run_bench.h"
#include "tests/simulator/common/drive_clock.h"
#include "tests/simulator/drives/plan_drive.h"
#include "tests/simulator/layouts/plan_place.h"
#include "tests/simulator/sensors/gnss_sensor.h"
#include "tests/simulator/vehicle/simulated_rig.h"

namespace parkade {
namespace {

using simulator::Motion;

constexpr double kStateInterval = 0.1;  // [s]
constexpr int kDegreesOfFreedom = 4;    // yaw and position

struct CommandLine {
  std::vector<std::string> scenes = {"street", "lot"};
  std::vector<std::string> receivers = {"standard", "rtk"};
  int num_seeds = 30;
  int num_drives = 1;   // of one site
  double length = 500;  // [m]
  double bend = 3e-4;   // [rad/sqrt(m)] random walk of the odometry's heading
  double scale = 3e-4;  // of its length
  double memory = 60;   // [s] of the receiver's errors
  std::vector<std::string> assignments;
};

/// One site's errors against the truth.
struct Georeference {
  double horizontal = 0, vertical = 0;  ///< [m] RMS over its drives
  double yaw = 0;                       ///< [rad] mean over them
  double nees = 0;                      ///< of yaw and position at the site's center
};

Trajectory BentTruth(const Motion& motion, const CommandLine& line, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const double scale = 1 + line.scale * normal(random);
  std::vector<TrajectoryState> states;
  double yaw_error = 0.3;  // odometry's heading is arbitrary
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  std::optional<Rigid3> last;
  for (double t = 0; t < motion.Duration(); t += kStateInterval) {
    const Rigid3 pose = motion.WorldFromBody(t);
    if (last) {
      const Eigen::Vector3d step = pose.translation - last->translation;
      yaw_error += line.bend * std::sqrt(step.norm()) * normal(random);
      position += scale * (Eigen::AngleAxisd(yaw_error, Eigen::Vector3d::UnitZ()) * step);
    }
    last = pose;
    TrajectoryState& state = states.emplace_back();
    state.time = simulator::DriveEpoch(seed) + t;
    state.world_from_body = {
        Eigen::Quaterniond(Eigen::AngleAxisd(yaw_error, Eigen::Vector3d::UnitZ())) * pose.rotation,
        position};
  }
  return Trajectory(std::move(states));
}

/// A drive of a site that GNSS has placed.
struct PlacedDrive {
  simulator::DrivePlan plan;
  std::uint64_t seed = 0;
  GnssDrive gnss;  ///< the group's frame is the world
};

std::optional<PlacedDrive> PlaceDrive(const CommandLine& line,
                                      const simulator::RigKeyframe& keyframe,
                                      const std::string& receiver, std::uint64_t seed,
                                      const GnssAlignOptions& options,
                                      const std::optional<SiteDatum>& datum) {
  simulator::DriverOptions driver;
  driver.length = line.length;
  PlacedDrive drive{
      .plan = simulator::PlanDrive(keyframe, driver, 0, seed), .seed = seed, .gnss = {}};
  const Rig rig = simulator::MakeSimulatedRig({}, seed);
  simulator::SensorOptions sensors;
  sensors.gnss = receiver;
  sensors.gnss_memory = line.memory;
  const std::vector<GnssFix> fixes =
      simulator::SimulateGnss(drive.plan.motion, rig, simulator::SimulatedDatum(), sensors, seed);
  const Trajectory odometry = BentTruth(drive.plan.motion, line, seed);
  const auto alignment =
      AlignToGnss(odometry, fixes, *rig.vehicle->antenna_in_body, options, datum);
  if (!alignment) return std::nullopt;
  drive.gnss.alignment = *alignment;
  for (const TrajectoryState& state : odometry.states()) {
    drive.gnss.in_odom.push_back(state.world_from_body.translation);
    drive.gnss.in_group.push_back(
        drive.plan.motion.WorldFromBody(state.time - simulator::DriveEpoch(seed)).translation);
  }
  return drive;
}

/// A site whose drives are joined without error is turned and moved as a whole. One drive alone
/// keeps its own bends.
Georeference Compare(const std::vector<PlacedDrive>& drives) {
  std::vector<GnssDrive> gnss;
  std::vector<GnssAlignment> alignments;
  for (const PlacedDrive& drive : drives) {
    gnss.push_back(drive.gnss);
    alignments.push_back(drive.gnss.alignment);
  }
  const bool is_alone = drives.size() == 1;
  const Rigid3 world_from_site = EarthFromSite(simulator::SimulatedDatum()).Inverse() *
                                 EarthFromSite(alignments.front().datum);
  const Rigid3 site_from_group = *PlaceByGnss(gnss);
  Georeference errors;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double count = 0;
  for (const PlacedDrive& drive : drives)
    for (size_t i = 0; i < drive.gnss.in_group.size(); ++i) {
      const Eigen::Vector3d in_site =
          is_alone ? drive.gnss.alignment.site_from_odom * drive.gnss.in_odom[i]
                   : site_from_group * drive.gnss.in_group[i];
      const Eigen::Vector3d error = world_from_site * in_site - drive.gnss.in_group[i];
      mean += error;
      errors.horizontal += error.head<2>().squaredNorm();
      errors.vertical += error.z() * error.z();
      ++count;
    }
  errors.horizontal = std::sqrt(errors.horizontal / count);
  errors.vertical = std::sqrt(errors.vertical / count);
  errors.yaw = YawOf((world_from_site * site_from_group).rotation);
  // The fixes' center is near the drives': the mean error is the error there.
  Eigen::Vector4d error;
  error << errors.yaw, mean / count;
  errors.nees =
      error.dot(PlacementBy(alignments).covariance.ldlt().solve(error)) / kDegreesOfFreedom;
  return errors;
}

template <typename Field>
std::vector<double> Sorted(const std::vector<Georeference>& drives, Field Georeference::*field) {
  std::vector<double> values;
  for (const Georeference& drive : drives) values.push_back(std::abs(drive.*field));
  std::sort(values.begin(), values.end());
  return values;
}

void PrintRow(const std::string& scene, const std::string& receiver, double length, int num_failed,
              const std::vector<Georeference>& drives) {
  const auto describe = [](const std::vector<double>& sorted, double unit) {
    char text[96];
    const double mean =
        std::accumulate(sorted.begin(), sorted.end(), 0.0) / static_cast<double>(sorted.size());
    std::snprintf(text, sizeof text, "%.3f / %.3f / %.3f", mean * unit,
                  sorted[sorted.size() / 2] * unit, sorted.back() * unit);
    return std::string(text);
  };
  if (drives.empty()) return;
  const std::vector<double> nees = Sorted(drives, &Georeference::nees);
  const double mean_nees =
      std::accumulate(nees.begin(), nees.end(), 0.0) / static_cast<double>(nees.size());
  std::printf("| %s | %s | %zu of %.0f m | %d | %s | %s | %s | %.2f |\n", scene.c_str(),
              receiver.c_str(), drives.size(), length, num_failed,
              describe(Sorted(drives, &Georeference::horizontal), 1).c_str(),
              describe(Sorted(drives, &Georeference::vertical), 1).c_str(),
              describe(Sorted(drives, &Georeference::yaw), 180 / M_PI).c_str(), mean_nees);
  std::fflush(stdout);
}

void RunRow(const CommandLine& line, const std::string& scene, const std::string& receiver,
            const GnssAlignOptions& options) {
  std::vector<Georeference> sites;
  double length = 0;
  int num_failed = 0;
  for (int i = 0; i < line.num_seeds; ++i) {
    const auto seed = static_cast<std::uint64_t>(i + 1);
    const simulator::RigKeyframe keyframe =
        simulator::PlanPlace(scene, {.seed = seed, .ground_texel = 0.05});
    std::vector<PlacedDrive> drives;
    for (int k = 0; k < line.num_drives; ++k) {
      const std::optional<SiteDatum> datum =
          drives.empty() ? std::nullopt : std::optional(drives.front().gnss.alignment.datum);
      auto drive = PlaceDrive(line, keyframe, receiver, seed + static_cast<std::uint64_t>(1000 * k),
                              options, datum);
      if (!drive) continue;
      length += drive->plan.length;
      drives.push_back(std::move(*drive));
    }
    if (drives.empty()) {
      ++num_failed;
      continue;
    }
    sites.push_back(Compare(drives));
  }
  PrintRow(scene, receiver, length / line.num_seeds, num_failed, sites);
}

int Run(const CommandLine& line) {
  GnssAlignOptions options;
  SetOptions(line.assignments, options);
  std::printf(
      "Mean / median / worst over the sites.\n\n"
      "| scene | receiver | sites | not placed | position, m | height, m | yaw, deg | NEES |\n"
      "|---|---|---|---|---|---|---|---|\n");
  for (const std::string& scene : line.scenes)
    for (const std::string& receiver : line.receivers) RunRow(line, scene, receiver, options);
  return 0;
}

}  // namespace
}  // namespace parkade

int main(int argc, char** argv) {
  using namespace parkade;
  CLI::App app{
      "Puts simulated sites on Earth by the GNSS of their drives and compares with the truth.",
      "parkade-georeference-table"};
  CommandLine line;
  app.add_option("--scenes", line.scenes)->delimiter(',');
  app.add_option("--receivers", line.receivers, "standard, rtk")->delimiter(',');
  app.add_option("--seeds", line.num_seeds, "sites per row")->capture_default_str();
  app.add_option("--drives", line.num_drives, "of each site, on days of their own")
      ->capture_default_str();
  app.add_option("--memory", line.memory, "[s] of a receiver's slow errors")->capture_default_str();
  app.add_option("--length", line.length, "[m] of each drive")->capture_default_str();
  app.add_option("--bend", line.bend, "[rad/sqrt(m)] of the odometry's heading")
      ->capture_default_str();
  app.add_option("--scale", line.scale, "sigma of the odometry's scale")->capture_default_str();
  app.add_option("--set", line.assignments, "of the alignment: option=value");
  constexpr int kOneThread = 1;
  return RunBench(app, argc, argv, kOneThread, [&] { return Run(line); });
}
