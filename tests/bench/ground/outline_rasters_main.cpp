#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>

#include "core/error.h"
#include "core/files/file.h"
#include "core/options_json.h"
#include "mapping/evaluation/height_raster.h"
#include "mapping/mesh/read_ply.h"
#include "mapping/observation/observe_ground.h"
#include "mapping/observation/visible_points.h"
#include "mapping/surface/outline_features.h"
#include "mapping/surface/paint_tile.h"
#include "tests/bench/odometry/run_bench.h"
#include "tests/bench/suite/suite_drive.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFooter =
    R"(Paints the ground of drives that `parkade-simulate ... --semantic` made (SUITE/DRIVE/drive, SUITE/DRIVE/truth), from
true poses, and writes what the network of outlines learns from, per deck: OUT/DRIVE_N.json, DRIVE_N.features (float32,
channels x rows x columns) and DRIVE_N.truth (uint8: 0 not drivable, 1 drivable, 2 drivable but not seen by a camera,
3 not within 12 m of the path, or nothing is known).
Example: parkade-outline-rasters --suite SUITE --out RASTERS --set ground.use_semantics=false)";

constexpr double kMergeGap = 0.1;  // [m] overlapping triangles of one sheet
constexpr double kMaxGap = 0.5;    // [m] ground and truth further above each other are not the same
constexpr double kMaxPathDistance = 12;  // [m] as ground is judged
constexpr double kMaxDrop = 2.5;         // [m] of the path to a deck that it is on
constexpr double kWholeSite = 1e4;       // [m]
constexpr int kAlign = 16;               // cells
constexpr std::size_t kMinCells = 4000;  // of a deck

enum class Truth : std::uint8_t { kNotDrivable, kDrivable, kUnseen, kUnknown };

struct Options {
  GroundOptions ground;
  SurfaceOptions surface;

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("ground", ground);
    visit("mapping", surface);
  }
};

struct CommandLine {
  std::string suite, out;
  std::vector<std::string> drives, assignments;
  double keyframe_distance = GroundOptions().keyframe_distance;  ///< [m]
  int num_threads = 2;
};

std::vector<SurfacePainter::PaintedCell> Paint(const SuiteDrive& drive, const Options& options) {
  const Trajectory site_from_body = TrajectoryOf(drive.world_from_imu, drive.true_rig);
  GroundObservation seen = ObserveGround(*drive.log, site_from_body, {}, 0, options.ground);
  const DrivenPath path = MakeDrivenPath(0, drive.true_rig, site_from_body, seen.body_from_ground);
  std::vector<PosedGroundPatch> patches;
  for (GroundPatch& patch : seen.patches)
    if (const std::optional<Rigid3> pose = site_from_body.At(patch.time))
      patches.push_back({std::move(patch), *pose});
  const PatchesInMemory source(patches);
  const std::vector<DriveHeights> heights = {
      MeasureDriveHeights(source, &path, options.surface.Heights(), {})};
  const HeightField field = FitHeights(heights, std::span(&path, 1), options.surface.Heights(), {});
  const int cells_per_side =
      static_cast<int>(std::round(options.surface.height.spacing / options.surface.cell_size));
  const LatestDrives latest(source.views(), options.surface.latest_drives);
  const std::vector<FieldTile> tiles = CutIntoTiles(field, cells_per_side, kWholeSite);
  Require(!tiles.empty(), ErrorCode::kInvalidInput, "no ground was seen");
  FieldTile all = tiles[0];
  for (const FieldTile& tile : tiles) {
    all.core.extend(tile.core);
    all.window.extend(tile.window);
  }
  return PaintTile(all, source, std::span(&path, 1), latest, field,
                   FitRoad(heights, std::span(&path, 1), options.surface.Heights()),
                   options.surface);
}

void Write(const fs::path& name, const cv::Mat& features, const std::vector<Truth>& truth) {
  const nlohmann::json json = {
      {"channels", features.size[1]}, {"rows", features.size[2]}, {"columns", features.size[3]}};
  WriteFileAtomically(name.string() + ".json", json.dump() + "\n");
  WriteFileAtomically(
      name.string() + ".features",
      std::string(reinterpret_cast<const char*>(features.data), features.total() * sizeof(float)));
  WriteFileAtomically(name.string() + ".truth",
                      std::string(reinterpret_cast<const char*>(truth.data()), truth.size()));
}

/// The true ground of a drive, and what of it its cameras saw.
class TrueGround {
 public:
  TrueGround(const TriangleMesh& mesh, double spacing, const SuiteDrive& drive)
      : spacing_(spacing),
        raster_(mesh, spacing, kMergeGap),
        path_(PathOf(TrajectoryOf(drive.world_from_imu, drive.true_rig))) {
    std::vector<Eigen::Vector3d> points;
    for (const HeightRaster::Sample& sample : raster_.samples())
      points.push_back(raster_.PointOf(sample));
    is_seen_ = FindVisiblePoints(points, *drive.log, drive.world_from_imu);
  }

  Truth At(const Eigen::Vector3d& place) const {
    if (!IsNearPath(place)) return Truth::kUnknown;
    const Eigen::Array2i at = (place.head<2>() / spacing_).array().floor().cast<int>();
    const int found = raster_.Find(at.x(), at.y(), place.z(), kMaxGap);
    if (found < 0) return Truth::kNotDrivable;
    return is_seen_[static_cast<size_t>(found)] ? Truth::kDrivable : Truth::kUnseen;
  }

 private:
  bool IsNearPath(const Eigen::Vector3d& place) const {
    return std::any_of(path_.begin(), path_.end(), [&](const Eigen::Vector3d& at) {
      return std::abs(at.z() - place.z()) < kMaxDrop &&
             (at - place).head<2>().norm() < kMaxPathDistance;
    });
  }

  double spacing_;
  HeightRaster raster_;
  std::vector<Eigen::Vector3d> path_;
  std::vector<bool> is_seen_;
};

std::vector<Truth> LabelsOf(std::span<const SurfacePainter::PaintedCell> cells,
                            const DeckRaster& deck, double cell_size, const TrueGround& truth) {
  std::vector<Truth> labels;
  for (int row = 0; row < deck.index.rows; row += kOutlineFactor)
    for (int column = 0; column < deck.index.cols; column += kOutlineFactor) {
      const int i = deck.index.at<int>(row, column);
      if (i < 0) {
        labels.push_back(Truth::kUnknown);
        continue;
      }
      const Eigen::Vector2d middle =
          cell_size * (deck.origin + Eigen::Vector2i(column, row)).cast<double>().array() +
          0.5 * kOutlineFactor * cell_size;
      labels.push_back(
          truth.At({middle.x(), middle.y(), cells[static_cast<size_t>(i)].cell.height}));
    }
  return labels;
}

void RunDrive(const CommandLine& line, const std::string& name, const Options& options) {
  const SuiteDrive drive = OpenSuiteDrive(line.suite, name);
  const std::vector<SurfacePainter::PaintedCell> cells = Paint(drive, options);
  const double cell_size = options.surface.cell_size;
  const TrueGround truth(ReadPly(fs::path(line.suite) / name / "truth" / "ground_truth.ply"),
                         kOutlineFactor * cell_size, drive);
  const std::vector<DeckRaster> decks =
      CutIntoDecks(cells, LinkPaintedCells(cells, kMaxCellStep), kAlign, kMinCells);
  for (size_t k = 0; k < decks.size(); ++k)
    Write(fs::path(line.out) / (name + "_" + std::to_string(k)),
          OutlineFeatures(cells, decks[k], OutlineWindow(decks[k])),
          LabelsOf(cells, decks[k], cell_size, truth));
  std::printf("%s: %zu decks, %zu cells\n", name.c_str(), decks.size(), cells.size());
  std::fflush(stdout);
}

int Run(const CommandLine& line) {
  Options options;
  options.ground.keyframe_distance = line.keyframe_distance;
  for (const std::string& assignment : line.assignments) SetOption(assignment, options);
  fs::create_directories(line.out);
  for (const std::string& name : line.drives.empty() ? ListSuite(line.suite) : line.drives)
    RunDrive(line, name, options);
  return 0;
}

}  // namespace
}  // namespace parkade

int main(int argc, char** argv) {
  using namespace parkade;
  CLI::App app{"Writes rasters that the network of outlines is trained with.",
               "parkade-outline-rasters"};
  CommandLine line;
  app.footer(kFooter);
  app.add_option("--suite", line.suite, "Folder that parkade-simulate suite filled")->required();
  app.add_option("--out", line.out, "Folder")->required();
  app.add_option("--only", line.drives, "Some drives; default: all")->delimiter(',');
  app.add_option("--set", line.assignments, "Of the map: ground.grid.max_range=10");
  app.add_option("--keyframe-distance", line.keyframe_distance, "[m] Images are taken so far apart")
      ->capture_default_str();
  app.add_option("--threads", line.num_threads, "Of one drive; drives go one after the other")
      ->capture_default_str()
      ->check(CLI::Range(1, 256));
  return RunBench(app, argc, argv, line.num_threads, [&] { return Run(line); });
}
