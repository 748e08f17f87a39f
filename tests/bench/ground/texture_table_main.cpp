#include <CLI/CLI.hpp>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "core/files/file.h"
#include "core/options_json.h"
#include "export/ortho.h"
#include "mapping/mesh/mesh_surface.h"
#include "mapping/observation/observe_ground.h"
#include "mapping/observation/visible_points.h"
#include "mapping/surface/fuse_surface.h"
#include "mapping/texture/paint_texture.h"
#include "server/ingest/drive/open_drive_log.h"
#include "tests/bench/ground/own_trace.h"
#include "tests/bench/odometry/run_bench.h"
#include "tests/bench/suite/suite_drive.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFooter =
    R"(Paints the ground of drives from true poses, once from their own images and once from those of the same drive
simulated with has_own_car=false, which lie beside it as NAME.bare. What differs is the own car, its body and its shadow.
Example: parkade-simulate lot --weather dry --out SUITE/a/drive.mcap --truth-out SUITE/a/truth
         parkade-simulate lot --weather dry --set has_own_car=false --out SUITE/a.bare/drive.mcap --truth-out SUITE/a.bare/truth
         parkade-texture-table --suite SUITE --only a --images images)";

struct TextureTableOptions {
  GroundOptions ground;
  SurfaceOptions surface;
  MeshOptions mesh;
  TextureOptions texture;

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("ground", ground);
    visit("mapping", surface);
    visit("mesh", mesh);
    visit("texture", texture);
  }
};

struct CommandLine {
  std::string suite, json_file, images_folder;
  std::vector<std::string> drives, assignments;
  int num_threads = 2;
};

/// What a drive's images are painted on.
struct MappedGround {
  DrivenPath path;
  SurfaceMap surface;
  TriangleMesh mesh;
  std::vector<PosedGroundPatch> patches;
};

MappedGround MapGround(const SuiteDrive& drive, const TextureTableOptions& options) {
  const Trajectory site_from_body = TrajectoryOf(drive.world_from_imu, drive.true_rig);
  GroundObservation seen = ObserveGround(*drive.log, site_from_body, {}, 0, options.ground);
  MappedGround ground;
  ground.path = MakeDrivenPath(0, drive.true_rig, site_from_body, seen.body_from_ground);
  for (GroundPatch& patch : seen.patches)
    if (const std::optional<Rigid3> pose = site_from_body.At(patch.time))
      ground.patches.push_back({std::move(patch), *pose});
  const PatchesInMemory source(ground.patches);
  const DriveHeights heights =
      MeasureDriveHeights(source, &ground.path, options.surface.Heights(), {});
  ground.surface =
      FuseSurface(source, std::span(&ground.path, 1), std::span(&heights, 1), options.surface, {});
  ground.mesh = MeshSurface(ground.surface, options.mesh);
  return ground;
}

GroundTexture Paint(const MappedGround& ground, const DriveLog& log,
                    const TextureOptions& options) {
  const TextureSource source{&log, &ground.path};
  return PaintTexture(ground.mesh, ground.surface, PatchesInMemory(ground.patches),
                      std::span(&source, 1), options);
}

/// The texture, and again with the car's traces in red.
void WriteImages(const MappedGround& ground, GroundTexture texture, const OwnTrace& trace,
                 const fs::path& file) {
  WriteFileAtomically(fs::path(file).concat(".png"),
                      EncodePng(RenderOrthophoto(ground.mesh, texture)));
  for (std::size_t i = 0; i < texture.charts.size(); ++i)
    texture.charts[i].image.setTo(cv::Scalar(0, 0, 255), trace.is_visible[i]);
  WriteFileAtomically(fs::path(file).concat("_trace.png"),
                      EncodePng(RenderOrthophoto(ground.mesh, texture)));
}

nlohmann::json RunDrive(const CommandLine& line, const std::string& name,
                        const TextureTableOptions& options) {
  const SuiteDrive drive = OpenSuiteDrive(line.suite, name);
  OpenLogOptions open;
  open.rig_folder = fs::path(line.suite) / name / "truth" / "rig_true";
  open.warn = false;
  const std::unique_ptr<DriveLog> bare =
      OpenDriveLog(fs::path(line.suite) / (name + ".bare") / "drive.mcap", open);
  const MappedGround ground = MapGround(drive, options);
  const std::clock_t start = std::clock();
  const GroundTexture texture = Paint(ground, *drive.log, options.texture);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  const GroundTexture without_car = Paint(ground, *bare, options.texture);
  const OwnTrace trace = FindOwnTrace(texture, without_car);
  std::printf(
      "%-12s own car visible on %7.3f %% of %5.0f m2 (dark %6.2f, bright %6.2f m2), "
      "painted in %.2f s of a processor\n",
      name.c_str(), 100 * trace.Share(), trace.painted, trace.dark, trace.bright, seconds);
  std::fflush(stdout);
  if (!line.images_folder.empty()) {
    fs::create_directories(line.images_folder);
    WriteImages(ground, texture, trace, fs::path(line.images_folder) / name);
    WriteFileAtomically(fs::path(line.images_folder) / (name + "_bare.png"),
                        EncodePng(RenderOrthophoto(ground.mesh, without_car)));
  }
  return {{"drive", name},         {"share", trace.Share()},    {"painted_m2", trace.painted},
          {"dark_m2", trace.dark}, {"bright_m2", trace.bright}, {"processor_s", seconds}};
}

int Run(const CommandLine& line) {
  TextureTableOptions options;
  for (const std::string& assignment : line.assignments) SetOption(assignment, options);
  nlohmann::json runs = nlohmann::json::array();
  for (const std::string& name : line.drives) runs.push_back(RunDrive(line, name, options));
  if (!line.json_file.empty()) WriteFileAtomically(line.json_file, runs.dump(1) + "\n");
  return 0;
}

}  // namespace
}  // namespace parkade

int main(int argc, char** argv) {
  using namespace parkade;
  CLI::App app{"How much of the own car the ground's texture shows.", "parkade-texture-table"};
  CommandLine line;
  app.footer(kFooter);
  app.add_option("--suite", line.suite, "Folder of simulated drives")->required();
  app.add_option("--only", line.drives, "The drives")->delimiter(',')->required();
  app.add_option("--set", line.assignments, "Of the map: texture.max_range=10");
  app.add_option("--threads", line.num_threads, "Of one run")
      ->capture_default_str()
      ->check(CLI::Range(1, 256));
  app.add_option("--json", line.json_file, "Every run");
  app.add_option(
      "--images", line.images_folder,
      "Three images per drive: its texture, with the car's traces in red, without a car");
  return RunBench(app, argc, argv, line.num_threads, [&] { return Run(line); });
}
