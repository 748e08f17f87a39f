#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>

#include "export/write_site_map.h"
#include "mapping/mesh/mesh_surface.h"
#include "mapping/surface/fuse_surface.h"
#include "mapping/texture/paint_texture.h"
#include "server/map_folder/surface_file.h"
#include "tests/bench/ground/large_site.h"
#include "tests/bench/ground/stage_cost.h"
#include "tests/bench/odometry/run_bench.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFooter =
    R"(Maps the ground of a square site of lanes that is made up as it is looked at, and says what each stage takes: the
most that was in memory at once (what lies in files and was not put aside, too), the most that cannot be put aside, and
processor time. Large arrays lie in $TMPDIR.
Example: parkade-ground-scale --hectares 4 --out /var/tmp/scale)";

struct CommandLine {
  double hectares = 1;
  std::string out;
  int num_threads = 1;
};

void Print(const StageCost& cost, double hectares) {
  std::printf("%-8s %9.0f MiB at most, %7.0f of its own, %8.1f s, per hectare %6.1f MiB %6.2f s\n",
              cost.name.c_str(), cost.peak_mebibytes, cost.peak_own_mebibytes,
              cost.processor_seconds, cost.peak_mebibytes / hectares,
              cost.processor_seconds / hectares);
  std::fflush(stdout);
}

/// What `run` makes, with its cost printed.
template <typename Run>
auto Measure(const std::string& name, double hectares, const Run& run) {
  StageMeter meter(name);
  auto result = run();
  Print(meter.Finish(), hectares);
  return result;
}

int RunStages(const CommandLine& line) {
  const LargeSite site(line.hectares);
  std::vector<HeightObservation> heights = site.Heights();
  const std::span path(&site.path(), 1);
  SiteMap map;
  map.surface = Measure("fuse", line.hectares, [&] {
    return FuseSurface(site.patches(), path, std::span<const DriveHeights>(), {}, heights);
  });
  heights = {};
  std::printf("         %zu cells\n", map.surface.cells.size());
  map.mesh = Measure("mesh", line.hectares, [&] { return MeshSurface(map.surface); });
  std::printf("         %zu triangles, %.0f m2\n", map.mesh.triangles.size(),
              SurfaceArea(map.mesh));
  const std::unique_ptr<DriveLog> log = site.Log();
  const TextureSource source{log.get(), &site.path()};
  map.texture = Measure("texture", line.hectares, [&] {
    return PaintTexture(map.mesh, map.surface, site.patches(), std::span(&source, 1));
  });
  std::printf("         %zu charts\n", map.texture.charts.size());
  map.drives.push_back(
      {log->name(), site.rig(), site.path().site_from_body, site.path().site_from_body});
  Measure("export", line.hectares, [&] {
    fs::create_directories(line.out);
    WriteSiteMap(map, line.out);
    WriteSurface(map.surface, fs::path(line.out) / "surface.bin");
    return 0;
  });
  return 0;
}

}  // namespace
}  // namespace parkade

int main(int argc, char** argv) {
  using namespace parkade;
  CommandLine line;
  CLI::App app("What mapping large sites takes", "parkade-ground-scale");
  app.footer(kFooter);
  app.add_option("--hectares", line.hectares, "of the site, a fifth of it drivable")
      ->capture_default_str();
  app.add_option("--out", line.out, "folder for the map's files")->required();
  app.add_option("--threads", line.num_threads)->capture_default_str();
  return RunBench(app, argc, argv, line.num_threads, [&] { return RunStages(line); });
}
