#include "server/pipeline/report.h"

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/files/file.h"
#include "core/options_json.h"
#include "core/version.h"
#include "export/markings.h"
#include "server/map_folder/loop_images.h"
#include "slam/sessions/drive_join_json.h"

namespace parkade {
namespace {

using Json = nlohmann::ordered_json;

Json NumbersOf(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

Json GnssToJson(const std::optional<GnssAlignment>& gnss) {
  if (!gnss) return nullptr;
  return {{"num_fixes", gnss->num_fixes},
          {"num_inliers", gnss->num_inliers},
          {"extent", gnss->extent},
          {"yaw_sigma", gnss->YawSigma()},
          {"horizontal_rmse", gnss->horizontal_rmse},
          {"vertical_rmse", gnss->vertical_rmse},
          {"cep50", gnss->cep50},
          {"cep95", gnss->cep95}};
}

Json InputToJson(const InputHash& input) {
  return {{"name", input.name}, {"bytes", input.bytes}, {"sha256", input.sha256}};
}

/// Decisions on loops, or on links.
template <typename Review>
Json ReviewToJson(const Review& review) {
  return {{"rejected", review.rejected}, {"forced", review.forced}};
}

/// The loops with what reviewers decided on them, which the next build from this map keeps.
Json LoopsToJson(const DriveOutcome& outcome, const Rig& rig, const std::string& drive) {
  Json json = LoopsToJson(outcome.loops, rig, drive);
  json["review"] = ReviewToJson(outcome.review);
  return json;
}

/// What the log holds, and what is wrong with it. Where odometry was taken from an earlier build,
/// no pass of this one has decoded every image: then those that odometry did not get are the
/// damaged ones.
DriveLogHealth HealthOf(const RecordedDrive& log, const DriveOutcome& outcome) {
  DriveLogHealth health = log.health();
  health.findings.insert(health.findings.end(), outcome.findings.begin(), outcome.findings.end());
  for (StreamHealth& stream : health.streams)
    for (const CameraHealth& camera : outcome.odometry.cameras) {
      const auto num_images = static_cast<std::uint64_t>(camera.frames);
      if (stream.role != camera.name || stream.num_delivered <= num_images) continue;
      stream.Dropped(DropReason::kDamaged) += stream.num_delivered - num_images;
      stream.num_delivered = num_images;
    }
  return health;
}

Json DriveToJson(const SiteDrive& drive, const DriveOutcome& outcome, const RecordedDrive& log,
                 const DriveInputs& inputs) {
  const nlohmann::json health = HealthToJson(HealthOf(log, outcome));
  return {{"name", drive.name},
          {"log", InputToJson(inputs.log)},
          {"rig", inputs.rig ? InputToJson(*inputs.rig) : Json(nullptr)},
          {"length", drive.odometry.Length()},
          {"duration", drive.odometry.span().Seconds()},
          {"num_cameras", drive.rig.cameras.size()},
          {"num_keyframes", outcome.num_keyframes},
          {"num_ground_images", outcome.num_ground_images},
          {"streams", health.value("streams", nlohmann::json::array())},
          {"health", health},
          {"odometry", ToJson(outcome.odometry)},
          {"loops", LoopsToJson(outcome, drive.rig, drive.name)},
          {"refinement", ToJson(outcome.refinement)},
          {"gnss", GnssToJson(outcome.gnss)}};
}

/// "NAME=VERSION NAME=VERSION ..." as the program was built with them.
Json LibrariesToJson(const char* versions) {
  Json json = Json::object();
  std::istringstream words(versions);
  for (std::string word; words >> word;) {
    const size_t at = word.find('=');
    json[word.substr(0, at)] = word.substr(at + 1);
  }
  return json;
}

/// Counts slots by kind and by what the last drive that saw them saw.
Json SlotsToJson(const SiteMap& map) {
  Json json = {{"count", map.markings.slots.size()},
               {"perpendicular", 0},
               {"angled", 0},
               {"parallel", 0},
               {"free", 0},
               {"occupied", 0},
               {"unseen", 0}};
  for (const ParkingSlot& slot : map.markings.slots)
    for (const char* key : {ToText(slot.kind), ToText(LatestState(slot))})
      json[key] = json[key].get<int>() + 1;
  return json;
}

Json MapToJson(const SiteMap& map) {
  size_t num_free = 0;
  for (const SurfaceCell& cell : map.surface.cells) num_free += cell.free_belief > 0.5F;
  const double cell_area = map.surface.cell_size * map.surface.cell_size;
  return {{"ground_area", SurfaceArea(map.mesh)},
          {"free_cell_area", static_cast<double>(num_free) * cell_area},
          {"num_cells", map.surface.cells.size()},
          {"num_vertices", map.mesh.vertices.size()},
          {"num_triangles", map.mesh.triangles.size()},
          {"slots", SlotsToJson(map)},
          {"num_markings", map.markings.markings.size()},
          {"num_speed_bumps", map.markings.bumps.size()},
          {"num_kerbs", map.markings.kerbs.size()}};
}

/// Statistics of the ground and the trajectories.
Eigen::AlignedBox3d BoundsOf(const SiteMap& map) {
  Eigen::AlignedBox3d bounds;
  for (const Eigen::Vector3f& vertex : map.mesh.vertices)
    bounds.extend(map.mesh.origin + vertex.cast<double>());
  for (const SiteDrive& drive : map.drives)
    for (const TrajectoryState& state : drive.site_from_body_trajectory.states())
      bounds.extend(state.world_from_body.translation);
  return bounds;
}

/// One drive of the report, with what the next build from this map must know to take its odometry.
Json LeftOutToJson(const LeftOutDrive& drive,
                   const std::vector<std::unique_ptr<RecordedDrive>>& logs,
                   const std::map<std::string, DriveInputs>& inputs) {
  Json json = {{"name", drive.name}, {"reason", drive.reason}};
  if (!drive.log) return json;
  json["log"] = InputToJson(inputs.at(drive.name).log);
  json["streams"] = HealthToJson(logs[*drive.log]->health()).value("streams", Json::array());
  json["loops"]["review"] = ReviewToJson(drive.review);
  return json;
}

}  // namespace

void WriteReport(const BuiltMap& built, const std::vector<std::unique_ptr<RecordedDrive>>& logs,
                 const MapOptions& options, const std::map<std::string, DriveInputs>& inputs,
                 const std::vector<StageTiming>& timings, const std::filesystem::path& file) {
  const SiteMap& map = built.site;
  Json report;
  report["version"] = kVersion;
  report["libraries"] = LibrariesToJson(PARKADE_LIBRARY_VERSIONS);
  report["options"] = OptionsToJson(options);
  for (const StageTiming& timing : timings)
    report["stages"].push_back({{"name", timing.name},
                                {"seconds", timing.seconds},
                                {"processor_seconds", timing.processor_seconds},
                                {"peak_memory_bytes", timing.peak_memory_bytes}});
  report["peak_memory_bytes"] = PeakMemoryBytes();
  report["datum"] = nullptr;
  if (map.datum) {
    report["datum"] = {{"latitude_deg", map.datum->latitude_deg},
                       {"longitude_deg", map.datum->longitude_deg},
                       {"altitude", map.datum->altitude},
                       {"is_altitude_known", map.datum->is_altitude_known}};
  }
  report["georeference"] = GeoreferenceToJson(map, built.pinning);
  report["pins"] = PinsToJson(built.pinning);
  const Eigen::AlignedBox3d bounds = BoundsOf(map);
  report["bounds"] = {{"min", NumbersOf(bounds.min())}, {"max", NumbersOf(bounds.max())}};
  for (size_t i = 0; i < map.drives.size(); ++i)
    report["drives"].push_back(DriveToJson(
        map.drives[i], built.drives[i], *logs[built.drives[i].log], inputs.at(map.drives[i].name)));
  if (built.names.size() > 1) {
    report["join"] = ToJson(built.join, built.names);
    report["join"]["review"] = ReviewToJson(built.link_review);
  }
  report["left_out"] = Json::array();
  for (const LeftOutDrive& drive : built.left_out)
    report["left_out"].push_back(LeftOutToJson(drive, logs, inputs));
  report["map"] = MapToJson(map);
  report["warnings"] = built.warnings;
  // Names of topics come from the log and may hold any bytes.
  WriteFileAtomically(file, report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace parkade
