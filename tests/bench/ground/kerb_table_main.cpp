#include <CLI/CLI.hpp>
#include <ctime>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/files/file.h"
#include "core/options_json.h"
#include "mapping/evaluation/evaluate_kerbs.h"
#include "mapping/kerbs/find_kerbs.h"
#include "mapping/kerbs/kerb_sweep.h"
#include "mapping/mesh/mesh_surface.h"
#include "mapping/observation/observe_ground.h"
#include "mapping/observation/visible_points.h"
#include "server/map_folder/kerbs_file.h"
#include "tests/bench/odometry/run_bench.h"
#include "tests/bench/suite/suite_drive.h"
#include "tests/mapping/worlds/fuse_patches.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFooter =
    R"(Maps the ground of drives that `parkade-simulate suite` made from true poses and the true rig, and compares its kerbs
with the true ones within 8 m of the path. Drives of older versions have no true kerbs: --truth names a folder of
DRIVE.geojson, as `parkade-simulate SCENE --seed N --kerbs FILE` writes them.
Examples: parkade-kerb-table --suite SUITE --only sim1,lot-day1 --json kerbs.json
          parkade-kerb-table --suite SUITE --set ground.use_semantics=false)";

struct KerbTableOptions {
  GroundOptions ground;
  SurfaceOptions surface;
  MeshOptions mesh;
  KerbOptions kerbs;

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("ground", ground);
    visit("mapping", surface);
    visit("mesh", mesh);
    visit("kerbs", kerbs);
  }
};

struct CommandLine {
  std::string suite, truth, json_file;
  std::vector<std::string> drives, assignments;
  int num_threads = 2;
};

struct KerbRun {
  std::vector<Kerb> kerbs;
  KerbEvaluation evaluation;
  double seconds = 0;  ///< of processor time, to find them
};

KerbRun RunDrive(const CommandLine& line, const std::string& name,
                 const KerbTableOptions& options) {
  const SuiteDrive drive = OpenSuiteDrive(line.suite, name);
  const Trajectory world_from_body = TrajectoryOf(drive.world_from_imu, drive.true_rig);
  GroundObservation seen = ObserveGround(*drive.log, world_from_body, {}, 0, options.ground);
  const DrivenPath path = MakeDrivenPath(0, drive.true_rig, world_from_body, seen.body_from_ground);
  std::vector<PosedGroundPatch> patches;
  for (GroundPatch& patch : seen.patches)
    if (const std::optional<Rigid3> pose = world_from_body.At(patch.time))
      patches.push_back({std::move(patch), *pose});
  const SurfaceMap surface = FuseSurface(patches, std::span(&path, 1), options.surface);
  const TriangleMesh mesh = MeshSurface(surface, options.mesh);

  KerbRun run;
  const std::clock_t start = std::clock();
  run.kerbs =
      FindKerbs(mesh, surface, PatchesInMemory(patches), std::span(&path, 1), options.kerbs);
  run.seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  const fs::path truth = line.truth.empty()
                             ? fs::path(line.suite) / name / "truth" / "kerbs.geojson"
                             : fs::path(line.truth) / (name + ".geojson");
  VisiblePointsOptions near;
  near.max_distance = kMaxKerbDistance;
  const KerbScope scope{PathOf(world_from_body), {[&](const std::vector<Eigen::Vector3d>& points) {
                          return FindVisiblePoints(points, *drive.log, drive.world_from_imu, near);
                        }}};
  run.evaluation = EvaluateKerbs(ReadTrueKerbs(truth, {}), run.kerbs, scope);
  return run;
}

nlohmann::json ToJson(const std::string& name, const KerbRun& run) {
  nlohmann::json kerbs = nlohmann::json::array();
  for (const Kerb& kerb : run.kerbs) {
    nlohmann::json points = nlohmann::json::array();
    for (const Eigen::Vector3d& point : kerb.points)
      points.push_back({point.x(), point.y(), point.z()});
    kerbs.push_back(
        {{"height", kerb.height}, {"height_sigma", kerb.height_sigma}, {"points", points}});
  }
  return {{"drive", name},
          {"seconds", run.seconds},
          {"evaluation", ToJson(run.evaluation)},
          {"kerbs", kerbs}};
}

int Run(const CommandLine& line) {
  KerbTableOptions options;
  for (const std::string& assignment : line.assignments) SetOption(assignment, options);
  nlohmann::json json = {{"options", OptionsToJson(options)}, {"runs", nlohmann::json::array()}};
  for (const std::string& name : line.drives.empty() ? ListSuite(line.suite) : line.drives) {
    const KerbRun run = RunDrive(line, name, options);
    const KerbEvaluation& e = run.evaluation;
    std::printf(
        "%-12s recall %5.1f %% of %4.0f m  precision %5.1f %% of %4.0f m in %2zu  height %.3f "
        "median %.3f p95 %+.3f "
        "bias  %.1f sigmas  %.1f s\n",
        name.c_str(), e.recall_percent, e.true_length, e.precision_percent, e.found_length,
        run.kerbs.size(), e.height_median, e.height_p95, e.height_bias, e.height_normalized_rmse,
        run.seconds);
    std::fflush(stdout);
    json["runs"].push_back(ToJson(name, run));
    if (!line.json_file.empty()) WriteFileAtomically(line.json_file, json.dump(1) + "\n");
  }
  return 0;
}

}  // namespace
}  // namespace parkade

int main(int argc, char** argv) {
  using namespace parkade;
  CLI::App app{"How well kerbs are found on rendered drives.", "parkade-kerb-table"};
  CommandLine line;
  app.footer(kFooter);
  app.add_option("--suite", line.suite, "Folder that parkade-simulate suite filled")->required();
  app.add_option("--truth", line.truth, "Folder of true kerbs; default: those of the suite");
  app.add_option("--only", line.drives, "Some drives; default: all that are there")->delimiter(',');
  app.add_option("--set", line.assignments, "Of the map: kerbs.min_views=4");
  app.add_option("--threads", line.num_threads, "Of one run")
      ->capture_default_str()
      ->check(CLI::Range(1, 256));
  app.add_option("--json", line.json_file, "Every run, with its kerbs");
  return RunBench(app, argc, argv, line.num_threads, [&] { return Run(line); });
}
