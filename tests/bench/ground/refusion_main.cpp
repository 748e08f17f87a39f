#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <string>
#include <utility>
#include <vector>

#include "core/options_json.h"
#include "mapping/heights/moved_heights.h"
#include "mapping/mesh/mesh_surface.h"
#include "mapping/observation/observe_ground.h"
#include "mapping/observation/visible_points.h"
#include "mapping/surface/fuse_surface.h"
#include "tests/bench/odometry/run_bench.h"
#include "tests/bench/suite/suite_drive.h"

namespace parkade {
namespace {

constexpr const char* kFooter =
    R"(Observes the ground of a drive that `parkade-simulate suite` made once, then finds its heights, fuses and meshes it
again and again, as after every change of poses: heights hold where poses near each other moved by less than 3 mm, and
are measured again, by one round, where they moved by more, as if the second half of the drive had been lifted by 10 mm.
The least of many runs says more than their mean where other programs share the machine; two builds are compared by runs
in turns.
Example: parkade-refusion --suite SUITE --only out11 --runs 10)";

struct RefusionOptions {
  GroundOptions ground;
  SurfaceOptions surface;
  MeshOptions mesh;

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("ground", ground);
    visit("mapping", surface);
    visit("mesh", mesh);
  }
};

struct CommandLine {
  std::string suite, drive;
  std::vector<std::string> assignments;
  int num_runs = 10;
  int num_threads = 2;
};

/// [s]
struct Cost {
  double wall = 0, processor = 0;
};

template <typename Work>
Cost CostOf(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t processor_start = std::clock();
  work();
  return {std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
          static_cast<double>(std::clock() - processor_start) / CLOCKS_PER_SEC};
}

Cost Sum(const Cost& a, const Cost& b) { return {a.wall + b.wall, a.processor + b.processor}; }

void Print(const char* name, std::vector<Cost> costs, double length) {
  const auto least_and_median = [&](auto member) {
    std::vector<double> values;
    for (const Cost& cost : costs) values.push_back(cost.*member / length * 1000);
    std::sort(values.begin(), values.end());
    return std::pair(values.front(), values[values.size() / 2]);
  };
  const auto [wall, median_wall] = least_and_median(&Cost::wall);
  const auto [processor, median_processor] = least_and_median(&Cost::processor);
  std::printf("%-18s %6.1f (median %6.1f) s per km, processor %6.1f (median %6.1f)\n", name, wall,
              median_wall, processor, median_processor);
}

/// The poses of the second half of the drive lie higher.
Trajectory Lifted(const Trajectory& path) {
  constexpr double kLift = 0.01;  // [m]
  std::vector<TrajectoryState> states = path.states();
  for (std::size_t i = states.size() / 2; i < states.size(); ++i)
    states[i].world_from_body.translation.z() += kLift;
  return Trajectory(std::move(states));
}

int Run(const CommandLine& line) {
  RefusionOptions options;
  for (const std::string& assignment : line.assignments) SetOption(assignment, options);
  const SuiteDrive drive = OpenSuiteDrive(line.suite, line.drive);
  const Trajectory site_from_body = TrajectoryOf(drive.world_from_imu, drive.true_rig);
  GroundObservation seen = ObserveGround(*drive.log, site_from_body, {}, 0, options.ground);
  const DrivenPath path = MakeDrivenPath(0, drive.true_rig, site_from_body, seen.body_from_ground);
  std::vector<PosedGroundPatch> patches;
  for (GroundPatch& patch : seen.patches)
    if (const std::optional<Rigid3> pose = site_from_body.At(patch.time))
      patches.push_back({std::move(patch), *pose});
  const PatchesInMemory source(patches);
  const Trajectory lifted = Lifted(site_from_body);
  std::vector<Cost> heights_costs, again_costs, fuse_costs, mesh_costs, held_costs, mended_costs,
      costs;
  for (int run = 0; run < line.num_runs; ++run) {
    DriveHeights heights;
    SurfaceMap surface;
    heights_costs.push_back(CostOf(
        [&] { heights = MeasureDriveHeights(source, &path, options.surface.Heights(), {}); }));
    again_costs.push_back(CostOf([&] {
      const HeightOptions height_options = options.surface.Heights();
      const MovedHeights moved = FindMovedHeights(heights, lifted, height_options);
      MeasureMovedHeights(source, path, height_options, heights, moved.squares);
    }));
    fuse_costs.push_back(CostOf([&] {
      surface =
          FuseSurface(source, std::span(&path, 1), std::span(&heights, 1), options.surface, {});
    }));
    mesh_costs.push_back(CostOf([&] { MeshSurface(surface, options.mesh); }));
    held_costs.push_back(Sum(fuse_costs.back(), mesh_costs.back()));
    mended_costs.push_back(Sum(again_costs.back(), held_costs.back()));
    costs.push_back(Sum(heights_costs.back(), held_costs.back()));
  }
  const double length = site_from_body.Length();
  Print("heights", heights_costs, length);
  Print("heights again", again_costs, length);
  Print("fuse", fuse_costs, length);
  Print("mesh", mesh_costs, length);
  Print("where heights hold", held_costs, length);
  Print("where they move", mended_costs, length);
  Print("all", costs, length);
  return 0;
}

}  // namespace
}  // namespace parkade

int main(int argc, char** argv) {
  using namespace parkade;
  CLI::App app{"Times what is done again when poses change.", "parkade-refusion"};
  CommandLine line;
  app.footer(kFooter);
  app.add_option("--suite", line.suite, "Folder that parkade-simulate suite filled")->required();
  app.add_option("--only", line.drive, "The drive")->required();
  app.add_option("--runs", line.num_runs, "How often")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  app.add_option("--set", line.assignments, "Of the map: ground.grid.max_range=10");
  app.add_option("--threads", line.num_threads, "Of one run")
      ->capture_default_str()
      ->check(CLI::Range(1, 256));
  return RunBench(app, argc, argv, line.num_threads, [&] { return Run(line); });
}
