#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files/file.h"
#include "core/options_json.h"
#include "mapping/evaluation/evaluate_surface.h"
#include "mapping/mesh/mesh_surface.h"
#include "mapping/mesh/read_ply.h"
#include "mapping/observation/observe_ground.h"
#include "mapping/observation/visible_points.h"
#include "slam/evaluation/evaluate_trajectory.h"
#include "tests/bench/ground/ground_images.h"
#include "tests/bench/odometry/run_bench.h"
#include "tests/bench/suite/suite_drive.h"
#include "tests/mapping/worlds/fuse_patches.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFooter =
    R"(Maps the ground of drives that `parkade-simulate suite` made, from true poses and the true rig, or from the poses of
finished maps (MAPS/DRIVE/drive/trajectory.tum), and compares it with the truth: within 12 m of the path, and as far as
the log's masks show that a camera saw it within 12 m.
Examples: parkade-ground-table --suite SUITE --only sim1,in0,out0 --json ground.json --images images
          parkade-ground-table --suite SUITE --poses MAPS --set ground.use_semantics=false)";

struct GroundTableOptions {
  GroundOptions ground;
  SurfaceOptions surface;
  MeshOptions mesh;
  SurfaceEvaluationOptions evaluation;

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("ground", ground);
    visit("mapping", surface);
    visit("mesh", mesh);
    visit("evaluation", evaluation);
  }
};

struct CommandLine {
  std::string suite, poses, json_file, images_folder;
  std::vector<std::string> drives, assignments;
  int num_threads = 2;
  bool has_true_heights = false;
};

struct GroundRun {
  std::string drive, scene;
  double length = 0, duration = 0;  ///< [m], [s]
  double seconds = 0;               ///< to observe, fuse and mesh
  std::size_t num_triangles = 0;
  SurfaceEvaluation evaluation;
};

/// The poses to map with, and what moves them onto the truth.
struct MappedPoses {
  Trajectory site_from_body;
  Rigid3 world_from_site;
};

MappedPoses PosesOf(const SuiteDrive& drive, const std::string& maps) {
  if (maps.empty()) return {TrajectoryOf(drive.world_from_imu, drive.true_rig), {}};
  const std::vector<TimedPose> site_from_imu =
      ReadTum(fs::path(maps) / drive.name / "drive" / "trajectory.tum");
  return {TrajectoryOf(site_from_imu, drive.true_rig),
          EvaluateTrajectory(drive.world_from_imu, site_from_imu).rigid.truth_from_estimate};
}

/// Every fifth vertex of the truth, as if a perfect instrument had measured it.
std::vector<HeightObservation> HeightsOf(const TriangleMesh& truth, const Rigid3& site_from_world) {
  constexpr size_t kStep = 5;
  std::vector<HeightObservation> heights;
  for (size_t i = 0; i < truth.vertices.size(); i += kStep)
    heights.push_back({site_from_world * (truth.vertices[i].cast<double>() + truth.origin), 1e6});
  return heights;
}

TriangleMesh MapGround(const SuiteDrive& drive, const Trajectory& site_from_body,
                       std::span<const HeightObservation> heights,
                       const GroundTableOptions& options) {
  GroundObservation seen = ObserveGround(*drive.log, site_from_body, {}, 0, options.ground);
  const DrivenPath path = MakeDrivenPath(0, drive.true_rig, site_from_body, seen.body_from_ground);
  std::vector<PosedGroundPatch> patches;
  for (GroundPatch& patch : seen.patches)
    if (const std::optional<Rigid3> pose = site_from_body.At(patch.time))
      patches.push_back({std::move(patch), *pose});
  return MeshSurface(FuseSurface(patches, std::span(&path, 1), options.surface, heights),
                     options.mesh);
}

GroundRun RunDrive(const CommandLine& line, const std::string& name,
                   const GroundTableOptions& options) {
  const SuiteDrive drive = OpenSuiteDrive(line.suite, name);
  const MappedPoses poses = PosesOf(drive, line.poses);
  GroundRun run;
  run.drive = name;
  run.scene = drive.scene;
  run.length = poses.site_from_body.Length();
  run.duration = drive.log->span().end - drive.log->span().begin;
  const TriangleMesh truth = ReadPly(fs::path(line.suite) / name / "truth" / "ground_truth.ply");
  std::vector<HeightObservation> heights;
  if (line.has_true_heights) heights = HeightsOf(truth, poses.world_from_site.Inverse());
  const auto start = std::chrono::steady_clock::now();
  const TriangleMesh mesh = MapGround(drive, poses.site_from_body, heights, options);
  run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  run.num_triangles = mesh.triangles.size();

  const std::vector<Eigen::Vector3d> path =
      PathOf(TrajectoryOf(drive.world_from_imu, drive.true_rig));
  const SurfaceScope scope{path, [&](const std::vector<Eigen::Vector3d>& points) {
                             return FindVisiblePoints(points, *drive.log, drive.world_from_imu);
                           }};
  const TriangleMesh estimate = Transformed(mesh, poses.world_from_site);
  run.evaluation = EvaluateSurface(truth, estimate, options.evaluation, scope);
  if (!line.images_folder.empty()) {
    fs::create_directories(line.images_folder);
    const fs::path folder = line.images_folder;
    WriteOutlineImage(truth, estimate, path, scope, folder / (name + ".png"));
    WriteHeightImage(truth, estimate, path, folder / (name + "_heights.png"));
  }
  return run;
}

void Print(const GroundRun& run) {
  const SurfaceEvaluation& e = run.evaluation;
  std::printf(
      "%-12s %-7s %5.0f m  accuracy %.4f  height %.4f median %.4f ramps %.4f  complete %6.2f %%  "
      "false %5.2f %%  "
      "IoU %.3f  boundary %.3f (%.3f over %.1f m)  %6zu triangles  %.2f of real time\n",
      run.drive.c_str(), run.scene.c_str(), run.length, e.accuracy_rmse, e.height_rmse,
      e.height_median, e.ramp_height_rmse, e.completeness_percent, e.false_free_percent, e.iou,
      e.boundary_iou, e.relative_boundary_iou, e.relative_boundary_width, run.num_triangles,
      run.seconds / run.duration);
  std::fflush(stdout);
}

int Run(const CommandLine& line) {
  GroundTableOptions options;
  for (const std::string& assignment : line.assignments) SetOption(assignment, options);
  nlohmann::json json = {{"options", OptionsToJson(options)}, {"threads", line.num_threads}};
  json["runs"] = nlohmann::json::array();
  for (const std::string& name : line.drives.empty() ? ListSuite(line.suite) : line.drives) {
    const GroundRun run = RunDrive(line, name, options);
    Print(run);
    json["runs"].push_back({{"drive", run.drive},
                            {"scene", run.scene},
                            {"length", run.length},
                            {"duration", run.duration},
                            {"seconds", run.seconds},
                            {"triangles", run.num_triangles},
                            {"surface", ToJson(run.evaluation)}});
    if (!line.json_file.empty()) WriteFileAtomically(line.json_file, json.dump(1) + "\n");
  }
  return 0;
}

}  // namespace
}  // namespace parkade

int main(int argc, char** argv) {
  using namespace parkade;
  CLI::App app{"Fills the table of goals of the ground from rendered drives.",
               "parkade-ground-table"};
  CommandLine line;
  app.footer(kFooter);
  app.add_option("--suite", line.suite, "Folder that parkade-simulate suite filled")->required();
  app.add_option("--only", line.drives, "Some drives; default: all that are there")->delimiter(',');
  app.add_option("--poses", line.poses,
                 "Folder of finished maps, one per drive; default: true poses");
  app.add_option("--set", line.assignments,
                 "Of the map or the evaluation: ground.grid.max_range=10");
  app.add_option("--threads", line.num_threads, "Of one run; runs go one after the other")
      ->capture_default_str()
      ->check(CLI::Range(1, 256));
  app.add_flag("--true-heights", line.has_true_heights,
               "Heights of the truth are known: what outlines alone cost");
  app.add_option("--json", line.json_file, "Every run");
  app.add_option("--images", line.images_folder,
                 "Two images per drive from above: outlines, and errors of height");
  return RunBench(app, argc, argv, line.num_threads, [&] { return Run(line); });
}
