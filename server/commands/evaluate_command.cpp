#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/trajectory.h"
#include "mapping/evaluation/evaluate_kerbs.h"
#include "mapping/evaluation/evaluate_slots.h"
#include "mapping/evaluation/evaluate_surface.h"
#include "mapping/evaluation/surface_picture.h"
#include "mapping/mesh/read_ply.h"
#include "mapping/observation/visible_points.h"
#include "server/commands/commands.h"
#include "server/commands/write_image.h"
#include "server/ingest/drive/open_drive_log.h"
#include "server/map_folder/kerbs_file.h"
#include "server/map_folder/map_reader.h"
#include "server/map_folder/slots_file.h"
#include "slam/evaluation/evaluate_trajectory.h"

namespace parkade {
namespace {

struct EvaluateArguments {
  std::string truth, estimate;  ///< TUM files
  std::string align =
      "yaw";  ///< or "poses": how what lies beside the trajectory is moved onto the truth
  std::string ground, surface;  ///< PLY meshes
  double within = 0;            ///< [m] of the true path; 0: everywhere
  std::string seen_in, rig;     ///< a log with masks, and the true rig
  std::string slots, map;  ///< true slots (GeoJSON), and the map whose slots are compared with them
  std::string picture;     ///< PNG of what is wrong about the surface
  std::string kerbs;       ///< true kerbs (GeoJSON), compared with those of `map`
  bool is_json = false;
};

/// The surfaces, within the scope that the arguments ask for.
SurfaceEvaluation EvaluateGround(const EvaluateArguments& arguments,
                                 const Rigid3& truth_from_estimate) {
  const bool is_scoped = arguments.within > 0 || !arguments.seen_in.empty();
  Require(!is_scoped || !arguments.truth.empty(), ErrorCode::kUsage,
          "--within and --seen-in need --truth");
  const std::vector<TimedPose> truth =
      is_scoped ? ReadTum(arguments.truth) : std::vector<TimedPose>{};
  SurfaceEvaluationOptions options;
  SurfaceScope scope;
  std::vector<Eigen::Vector3d> path;
  if (arguments.within > 0) {
    options.max_path_distance = arguments.within;
    for (const TimedPose& pose : truth) path.push_back(pose.world_from_frame.translation);
    scope.path = path;
  }
  std::unique_ptr<RecordedDrive> log;
  if (!arguments.seen_in.empty()) {
    OpenLogOptions open;
    open.rig_folder = arguments.rig;
    log = OpenDriveLog(arguments.seen_in, open);
    VisiblePointsOptions seen;
    if (arguments.within > 0) seen.max_distance = arguments.within;
    scope.find_seen = [&log, &truth, seen](const std::vector<Eigen::Vector3d>& points) {
      return FindVisiblePoints(points, *log, truth, seen);
    };
  }
  const TriangleMesh estimate = Transformed(ReadPly(arguments.surface), truth_from_estimate);
  const ScopedSurfaces surfaces =
      ScopeSurfaces(ReadPly(arguments.ground), estimate, options, scope);
  const SurfaceEvaluation evaluation = EvaluateSurface(surfaces, estimate, options);
  if (!arguments.picture.empty())
    WriteImage(arguments.picture,
               PaintSurfaceErrors(surfaces, evaluation.relative_boundary_width, options));
  return evaluation;
}

constexpr double kSlotRange = 8;  // [m] from which a camera may see the lines of a slot
constexpr double kKerbRange = 9;  // [m] from which a camera may see the ground before a kerb

/// The ground that the masks of a log show from near, where there is a log.
SlotScope ScopeOf(const EvaluateArguments& arguments, double max_distance) {
  if (arguments.seen_in.empty()) return {};
  Require(!arguments.truth.empty(), ErrorCode::kUsage, "--seen-in needs --truth");
  OpenLogOptions open;
  open.rig_folder = arguments.rig;
  const std::shared_ptr<RecordedDrive> log = OpenDriveLog(arguments.seen_in, open);
  VisiblePointsOptions seen;
  seen.max_distance = max_distance;
  return {
      [log, seen, truth = ReadTum(arguments.truth)](const std::vector<Eigen::Vector3d>& points) {
        return FindVisiblePoints(points, *log, truth, seen);
      }};
}

/// The slots of a map; those count whose lines were seen, where a log says so.
SlotEvaluation EvaluateMapSlots(const EvaluateArguments& arguments,
                                const Rigid3& truth_from_estimate) {
  const MapReader map(arguments.map);
  std::vector<ParkingSlot> found;
  for (const StoredSlot& stored : ReadSlots(map.FileNamed("slots.geojson"), map.datum())) {
    found.push_back(stored.slot);
    for (Eigen::Vector3d& corner : found.back().corners) corner = truth_from_estimate * corner;
  }
  return EvaluateSlots(ReadTrueSlots(arguments.slots, map.datum()), found,
                       ScopeOf(arguments, kSlotRange));
}

/// The kerbs of a map; those count that the true path came near, and that were seen, where a log
/// says so.
KerbEvaluation EvaluateMapKerbs(const EvaluateArguments& arguments,
                                const Rigid3& truth_from_estimate) {
  const MapReader map(arguments.map);
  std::vector<Kerb> found = ReadKerbs(map.FileNamed("markings.geojson"));
  for (Kerb& kerb : found)
    for (Eigen::Vector3d& point : kerb.points) point = truth_from_estimate * point;
  KerbScope scope;
  scope.ground = ScopeOf(arguments, kKerbRange);
  if (!arguments.truth.empty())
    for (const TimedPose& pose : ReadTum(arguments.truth))
      scope.path.push_back(pose.world_from_frame.translation);
  return EvaluateKerbs(ReadTrueKerbs(arguments.kerbs, map.datum()), found, scope);
}

int Evaluate(const EvaluateArguments& arguments) {
  const bool has_trajectories = !arguments.truth.empty() && !arguments.estimate.empty();
  const bool has_surfaces = !arguments.ground.empty() && !arguments.surface.empty();
  const bool has_slots = !arguments.slots.empty() && !arguments.map.empty();
  const bool has_kerbs = !arguments.kerbs.empty() && !arguments.map.empty();
  Require(has_trajectories || has_surfaces || has_slots || has_kerbs, ErrorCode::kUsage,
          "evaluate needs --truth with --estimate, --ground with --surface, or --slots or --kerbs "
          "with --map");
  Require(arguments.picture.empty() || has_surfaces, ErrorCode::kUsage,
          "--picture needs --ground and --surface");

  nlohmann::json json = nlohmann::json::object();
  std::string text;
  Rigid3 truth_from_estimate;
  if (has_trajectories) {
    const TrajectoryEvaluation evaluation =
        EvaluateTrajectory(ReadTum(arguments.truth), ReadTum(arguments.estimate));
    json["trajectory"] = ToJson(evaluation);
    text += ToText(evaluation);
    // The alignment by positions will not do: along a straight street they leave the roll open.
    truth_from_estimate = (arguments.align == "poses" ? evaluation.by_poses : evaluation.yaw_only)
                              .truth_from_estimate;
  }
  if (has_surfaces) {
    const SurfaceEvaluation evaluation = EvaluateGround(arguments, truth_from_estimate);
    json["surface"] = ToJson(evaluation);
    text += ToText(evaluation);
  }
  if (has_slots) {
    const SlotEvaluation evaluation = EvaluateMapSlots(arguments, truth_from_estimate);
    json["slots"] = ToJson(evaluation);
    text += ToText(evaluation);
  }
  if (has_kerbs) {
    const KerbEvaluation evaluation = EvaluateMapKerbs(arguments, truth_from_estimate);
    json["kerbs"] = ToJson(evaluation);
    text += ToText(evaluation);
  }
  std::printf("%s\n", arguments.is_json ? json.dump(2).c_str() : text.c_str());
  return 0;
}

}  // namespace

void AddEvaluateCommand(CLI::App& app, Action& action) {
  const auto arguments = std::make_shared<EvaluateArguments>();
  CLI::App* command = app.add_subcommand("evaluate",
                                         "Compare a trajectory, a surface, parking slots or kerbs "
                                         "with the truth; given a trajectory, the others "
                                         "are moved by its alignment first");
  command->add_option("--truth", arguments->truth, "true trajectory (TUM)");
  command->add_option("--estimate", arguments->estimate,
                      "estimated trajectory (TUM), poses of the same frame");
  command
      ->add_option("--align", arguments->align,
                   "yaw: both have z up; poses: a tilt against gravity is taken off, too (on a "
                   "straight street no "
                   "sensor tells it from the accelerometer's bias)")
      ->check(CLI::IsMember({"yaw", "poses"}))
      ->capture_default_str();
  command->add_option("--ground", arguments->ground, "true ground surface (PLY mesh, z up)");
  command->add_option("--surface", arguments->surface, "estimated surface (PLY mesh, z up)");
  command
      ->add_option("--within", arguments->within,
                   "only ground within so many meters of the true path, e.g. 12")
      ->check(CLI::PositiveNumber);
  command->add_option(
      "--seen-in", arguments->seen_in,
      "log with masks (<camera>/semantic): true ground that none of them shows within the same "
      "distance (else 12 m) is left out");
  command->add_option(
      "--picture", arguments->picture,
      "PNG of the surface from above, 10 cm to a pixel: gray right, red false, blue "
      "missed, orange where only one has an outline near");
  command->add_option("--slots", arguments->slots,
                      "true parking slots (GeoJSON); with --seen-in those of which a camera saw a "
                      "meter of both lines "
                      "within 8 m");
  command->add_option("--kerbs", arguments->kerbs,
                      "true kerbs (GeoJSON); with --truth those within 8 m of the true path, with "
                      "--seen-in those before "
                      "which a camera saw the ground within 9 m");
  command->add_option("--map", arguments->map,
                      "finished map (folder) whose slots and kerbs are compared with them");
  command->add_option("--rig", arguments->rig,
                      "true calibration of that log; default: the one in the log");
  command->add_flag("--json", arguments->is_json, "print JSON");
  command->callback(
      [arguments, &action] { action = [arguments] { return Evaluate(*arguments); }; });
}

}  // namespace parkade
