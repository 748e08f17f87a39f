#include "server/pipeline/build_map.h"

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/error.h"
#include "core/log.h"
#include "core/options_json.h"
#include "server/ingest/drive/drive_log_health.h"
#include "server/map_folder/finished_map.h"
#include "server/map_folder/tracked_by.h"
#include "server/pipeline/drive_stages.h"
#include "slam/odometry/calibrated_log.h"
#include "slam/odometry/odometry_file.h"

namespace parkade {
namespace {

/// A drive on its way into the map.
struct DriveInWork {
  const RecordedDrive* log = nullptr;
  OdometryResult odometry;
  bool is_odometry_taken = false;
  std::optional<CalibratedLog> calibrated;  ///< as all that follows the refinement sees it
  DriveOutcome outcome;
};

/// Where GNSS puts each drive, all in one datum: that of the first drive that has one.
std::optional<SiteDatum> AlignAllToGnss(const GnssAlignOptions& options, std::vector<DriveInWork>& drives) {
  std::optional<SiteDatum> datum;
  for (DriveInWork& drive : drives) {
    const GnssPositions gnss = ReadGnss(*drive.log, options);
    drive.outcome.gnss =
        AlignToGnss(drive.outcome.refinement.odom_from_body, gnss.fixes, gnss.antenna_in_body, options, datum);
    if (drive.outcome.gnss) datum = drive.outcome.gnss->datum;
  }
  return datum;
}

/// Puts the drive's final trajectory and its submaps into the site.
void AddDrive(const DriveInWork& drive, Trajectory&& site_from_body, const SubmapOptions& options, BuiltMap& built) {
  SiteMap& map = built.site;
  for (Submap& submap : CutIntoSubmaps(drive.odometry, static_cast<int>(map.drives.size()), options)) {
    const Timestamp begin = submap.keyframes.front().time;
    const Rigid3 site_from_odom = *site_from_body.At(begin) * drive.odometry.odom_from_body.At(begin)->Inverse();
    const Rigid3 site_from_submap = site_from_odom * submap.odom_from_submap;
    map.submaps.push_back({std::move(submap), site_from_submap});
  }
  map.drives.push_back(
      {drive.log->name(), drive.calibrated->rig(), drive.odometry.odom_from_body, std::move(site_from_body)});
  built.drives.push_back(drive.outcome);
}

/// Joins the drives to one site; those that do not fit are taken off the list.
void PlaceInSite(const MapOptions& options, DriveStages& stages, std::vector<DriveInWork>& drives, BuiltMap& built) {
  built.site.datum = AlignAllToGnss(options.gnss, drives);
  std::vector<DriveToJoin> to_join;
  for (const DriveInWork& drive : drives) {
    built.names.push_back(drive.log->name());
    const Trajectory& odom_from_body = drive.outcome.refinement.odom_from_body;
    std::vector<Place> places;
    if (drives.size() > 1)
      places = stages.FindPlaces(*drive.calibrated, drive.odometry, drive.outcome.refinement);
    else  // for maps that it is compared with, and drives that join it
      stages.KeepPlaces(*drive.calibrated, drive.odometry, drive.outcome.refinement);
    to_join.push_back(
        {odom_from_body, std::move(places), drive.outcome.loops, drive.outcome.gnss, drive.outcome.refinement.modes});
  }
  built.join = JoinDrives(to_join, options.loops, options.links, stages.MemoryOfPairs(built.names, to_join));
  bool has_gnss = false;
  std::vector<DriveInWork> kept;
  for (size_t i = 0; i < drives.size(); ++i) {
    JoinedDrive& joined = built.join.drives[i];
    if (!joined.left_out.empty()) {
      built.left_out.push_back({built.names[i], "it does not fit the others: " + joined.left_out, drives[i].outcome.log,
                                drives[i].outcome.review});
      continue;
    }
    has_gnss = has_gnss || drives[i].outcome.gnss;
    AddDrive(drives[i], std::move(joined.site_from_body), options.submaps, built);
    kept.push_back(std::move(drives[i]));
  }
  drives = std::move(kept);
  if (!has_gnss) built.site.datum.reset();
}

/// GNSS says how sure the site's place is; pins, where there are any, have the last word.
void PutOnEarth(const MapOptions& options, const BuildScope& scope, BuiltMap& built) {
  std::vector<GnssAlignment> by_gnss;
  for (const DriveOutcome& drive : built.drives)
    if (drive.gnss) by_gnss.push_back(*drive.gnss);
  if (!by_gnss.empty()) built.site.placement = PlacementBy(by_gnss);
  built.pinning = PinSite(scope.pins, options.pins, built.site);
  built.warnings.insert(built.warnings.end(), built.pinning.warnings.begin(), built.pinning.warnings.end());
}

/// What all drives saw of the ground, and where they drove, in the site.
struct SiteGround {
  StoredGround patches;
  std::vector<DrivenPath> paths;
  std::vector<DriveHeights> heights;
};

void ObserveGroundOf(const DriveInWork& work, int drive, bool measures_heights, DriveStages& stages, BuiltMap& built,
                     SiteGround& ground) {
  std::vector<Submap> submaps;
  for (const PosedSubmap& posed : built.site.submaps)
    if (posed.submap.drive == drive) submaps.push_back(posed.submap);
  const std::shared_ptr<const GroundFile> file = stages.ObserveGround(*work.calibrated, work.odometry, submaps);
  const GroundObservation& seen = file->observation();
  built.drives[static_cast<size_t>(drive)].num_ground_images = seen.num_images;
  built.warnings.insert(built.warnings.end(), seen.warnings.begin(), seen.warnings.end());
  if (measures_heights)
    ground.heights.push_back(stages.MeasureHeights(*work.calibrated, file, work.outcome.refinement, drive));

  const SiteDrive& site_drive = built.site.drives[static_cast<size_t>(drive)];
  const Trajectory& site_from_body = site_drive.site_from_body_trajectory;
  ground.paths.push_back(MakeDrivenPath(drive, site_drive.rig, site_from_body, seen.body_from_ground));
  ground.patches.Add(file, drive, site_from_body);
}

/// What of the logs was missing or lost, as far as they were read.
void WarnOfLogs(const std::vector<DriveInWork>& drives, std::vector<std::string>& warnings) {
  for (const DriveInWork& drive : drives) {
    const DriveLogHealth health = drive.log->health();
    const std::string name = "drive '" + drive.log->name() + "': ";
    for (const std::string& warning : health.warnings) warnings.push_back(name + warning);
    if (health.damage.is_truncated) warnings.push_back(name + "the log is cut off; what came after is not in the map");
    if (!health.damage.ranges.empty())
      warnings.push_back(name + "parts of the log are damaged and left out, see the health of the drive");
  }
}

constexpr const char* kOdometryFile = "odometry.bin";

OdometryResult ReadStoredOdometry(const RecordedDrive& log, const BuildScope& scope, const FinishedMap& from,
                                  const OdometryOptions& options, const std::filesystem::path& file) {
  if (const auto hash = scope.logs.find(log.name()); hash != scope.logs.end())
    Require(from.MayBeOf(log.name(), hash->second), ErrorCode::kInvalidInput, "it is of another log");
  const std::string tracked_by =
      TrackedBy({{"odometry", OptionsToJson(options)}}, HealthToJson(log.health()).at("streams"));
  Require(from.TrackedBy(log.name()) == tracked_by, ErrorCode::kInvalidInput,
          "it was tracked with other options or from other streams");
  OdometryResult odometry = ReadOdometry(file, log.rig());
  const TimeSpan stored = odometry.odom_from_body.span(), recorded = log.span();
  Require(recorded.Contains(stored.begin) && recorded.Contains(stored.end), ErrorCode::kInvalidInput,
          "it is of another log");
  return odometry;
}

/// In the map in the making, shared with the one that it was taken from.
void StoreOdometry(const OdometryResult& odometry, const DriveLog& log, const BuildScope& scope, bool is_taken) {
  const std::filesystem::path name = std::filesystem::path(log.name()) / kOdometryFile;
  if (is_taken) return LinkOrCopy(scope.from / name, scope.products / name);
  std::filesystem::create_directories(scope.products / log.name());
  WriteOdometry(odometry, log.rig(), scope.products / name);
}

/// From the map to start from where it holds this drive's, else tracked.
void FindOdometry(const BuildScope& scope, const std::optional<FinishedMap>& from, const OdometryOptions& options,
                  const ProgressCallback& progress, DriveInWork& drive) {
  const RecordedDrive& log = *drive.log;
  const std::filesystem::path file = scope.from / log.name() / kOdometryFile;
  if (from && std::filesystem::exists(file)) {
    try {
      drive.odometry = ReadStoredOdometry(log, scope, *from, options, file);
      if (!scope.products.empty()) StoreOdometry(drive.odometry, log, scope, /*is_taken=*/true);
      drive.is_odometry_taken = true;
      return;
    } catch (const Error& error) {
      LogWarning("drive '" + log.name() + "' is tracked again, as its stored odometry cannot be used: " + error.what());
    }
  }
  drive.odometry = EstimateTrajectory(log, options, progress);
  if (!scope.products.empty()) StoreOdometry(drive.odometry, log, scope, /*is_taken=*/false);
}

/// The map to start from; nothing where the build starts anew, or from a folder without a report.
std::optional<FinishedMap> OpenFrom(const BuildScope& scope) {
  if (scope.from.empty()) return std::nullopt;
  try {
    return FinishedMap(scope.from);
  } catch (const Error& error) {
    LogWarning(std::string("all drives are tracked: ") + error.what());
    return std::nullopt;
  }
}

/// The decisions of this build and, of the one that it starts from, those that it does not overrule. Places, by which
/// loops are called, are those of the odometry.
LoopReview ReviewFor(const DriveInWork& drive, const BuildScope& scope, const std::optional<FinishedMap>& from) {
  LoopReview review;
  if (const auto own = scope.loops.find(drive.log->name()); own != scope.loops.end()) review = own->second;
  if (!drive.is_odometry_taken) return review;
  const LoopReview now = review, before = from->ReviewOf(drive.log->name());
  const auto has = [](const std::vector<std::string>& loops, const std::string& loop) {
    return std::find(loops.begin(), loops.end(), loop) != loops.end();
  };
  const auto is_new = [&](const std::string& loop) { return !has(now.rejected, loop) && !has(now.forced, loop); };
  std::copy_if(before.rejected.begin(), before.rejected.end(), std::back_inserter(review.rejected), is_new);
  std::copy_if(before.forced.begin(), before.forced.end(), std::back_inserter(review.forced), is_new);
  return review;
}

std::vector<ClosedDrive> AsClosed(const std::vector<DriveInWork>& drives) {
  std::vector<ClosedDrive> closed;
  for (const DriveInWork& drive : drives)
    closed.push_back({drive.log->name(), drive.log->rig().body_from_imu, &drive.odometry.odom_from_body,
                      &drive.outcome.loops, drive.is_odometry_taken});
  return closed;
}

}  // namespace

std::vector<StagePlan> PlanStages(size_t num_drives, bool is_odometry_only) {
  // Weights are shares of the time that a typical drive takes.
  const double drives = static_cast<double>(num_drives);
  std::vector<StagePlan> plan = {{"track", 70 * drives},
                                 {"close loops", 15 * drives},
                                 {"refine", 10 * drives},
                                 {"join drives", num_drives > 1 ? 15 * drives : 2}};
  if (!is_odometry_only)
    plan.insert(plan.end(), {{"observe ground", 15 * drives},
                             {"fuse surface", 5 * drives},
                             {"mesh", 4 * drives},
                             {"texture", 15 * drives},
                             {"find markings", 2 * drives}});
  plan.push_back({"write", 4});
  return plan;
}

BuiltMap BuildMap(const std::vector<std::unique_ptr<RecordedDrive>>& logs, const MapOptions& options,
                  const BuildScope& scope, Progress& progress) {
  BuiltMap built;
  SiteMap& map = built.site;
  const std::optional<FinishedMap> from = OpenFrom(scope);
  const auto share_of_drive = [&](size_t i) {
    return [&progress, i, n = static_cast<double>(logs.size())](double fraction) {
      progress.Update((static_cast<double>(i) + fraction) / n);
    };
  };

  progress.Begin("track");
  built.left_out = scope.unreadable;
  std::vector<DriveInWork> drives;
  for (size_t i = 0; i < logs.size(); ++i) {
    DriveInWork drive;
    drive.log = logs[i].get();
    try {
      FindOdometry(scope, from, options.odometry, share_of_drive(i), drive);
    } catch (const Error& error) {
      if (logs.size() == 1 || error.code() != ErrorCode::kInvalidInput) throw;
      built.left_out.push_back({logs[i]->name(), error.what()});
      continue;
    }
    drive.outcome.log = i;
    drive.outcome.odometry = drive.odometry.report;
    drive.outcome.num_keyframes = drive.odometry.keyframes.size();
    drives.push_back(std::move(drive));
  }
  Require(
      !drives.empty(), ErrorCode::kInvalidInput,
      "none of the drives can be used; the first: " + (built.left_out.empty() ? "" : built.left_out.front().reason));

  DriveStages stages(scope.from, scope.products, options);
  progress.Begin("close loops");
  for (size_t i = 0; i < drives.size(); ++i) {
    const DriveLog& log = *drives[i].log;
    stages.Begin(log, scope.products.empty() ? std::filesystem::path() : scope.products / log.name() / kOdometryFile);
    drives[i].outcome.review = ReviewFor(drives[i], scope, from);
    drives[i].outcome.loops = stages.CloseLoops(log, drives[i].odometry, drives[i].outcome.review);
    share_of_drive(i)(1);
  }
  if (scope.on_closed) scope.on_closed(AsClosed(drives));

  progress.Begin("refine");
  for (size_t i = 0; i < drives.size(); ++i) {
    DriveInWork& drive = drives[i];
    drive.outcome.refinement = stages.Refine(*drive.log, drive.odometry, drive.outcome.loops);
    drive.odometry.measurements.reset();
    drive.calibrated.emplace(*drive.log, drive.outcome.refinement.rig);
    share_of_drive(i)(1);
  }

  progress.Begin("join drives");
  PlaceInSite(options, stages, drives, built);
  for (const LeftOutDrive& drive : built.left_out)
    built.warnings.push_back("drive '" + drive.name + "' is left out: " + drive.reason);
  WarnOfLogs(drives, built.warnings);
  PutOnEarth(options, scope, built);
  if (scope.on_placed) scope.on_placed(map);
  if (scope.is_odometry_only) return built;

  progress.Begin("observe ground");
  SiteGround ground;
  for (size_t i = 0; i < drives.size(); ++i) {
    ObserveGroundOf(drives[i], static_cast<int>(i), options.surface.method == "surface", stages, built, ground);
    share_of_drive(i)(1);
  }

  progress.Begin("fuse surface");
  map.surface = FuseSurface(ground.patches, ground.paths, ground.heights, options.surface);

  progress.Begin("mesh");
  map.mesh = MeshSurface(map.surface, options.mesh);
  if (map.mesh.empty()) built.warnings.push_back("no ground was found: the map holds trajectories only");

  progress.Begin("texture");
  std::vector<TextureSource> sources;
  for (size_t i = 0; i < drives.size(); ++i) sources.push_back({&*drives[i].calibrated, &ground.paths[i]});
  map.texture = PaintTexture(map.mesh, map.surface, ground.patches.views(), sources, options.texture);

  progress.Begin("find markings");
  map.markings = FindMarkings({map.mesh, map.surface, map.texture, ground.patches, ground.paths, map.drives.size()},
                              options.markings);
  return built;
}

}  // namespace parkade
