#include "server/build_map.h"

#include <iterator>
#include <utility>

#include "core/error.h"
#include "slam/calibrated_log.h"
#include "slam/odometry_file.h"

namespace parkade {
namespace {

std::vector<GnssFix> ReadFixes(const DriveLog& log) {
  ReadOptions only_gnss;
  only_gnss.imu = only_gnss.wheels = only_gnss.images = false;
  std::vector<GnssFix> fixes;
  const std::unique_ptr<RecordStream> records = log.Read(only_gnss);
  while (std::optional<SensorRecord> record = records->Next())
    if (const auto* fix = std::get_if<GnssFix>(&*record)) fixes.push_back(*fix);
  return fixes;
}

/// Puts the drive's trajectory, loops closed, and its submaps into the site.
void PlaceOnEarth(const DriveLog& log, size_t index, const GnssAlignOptions& options, SiteMap& map,
                  DriveOutcome& outcome, std::vector<Submap>&& submaps) {
  const Trajectory& odom_from_body = outcome.refinement.odom_from_body;
  SiteDrive& drive = map.drives[index];
  const std::optional<VehicleCalibration>& vehicle = log.rig().vehicle;
  const Eigen::Vector3d antenna_in_body =
      vehicle && vehicle->antenna_in_body ? *vehicle->antenna_in_body : Eigen::Vector3d::Zero();
  outcome.gnss = AlignToGnss(odom_from_body, ReadFixes(log), antenna_in_body, options, map.datum);
  const bool is_first = index == 0;
  Require(is_first || (map.datum && outcome.gnss), ErrorCode::kInvalidInput,
          "drive '" + drive.name + "' cannot be joined with the others: this version joins drives by GNSS, and " +
              (outcome.gnss ? "the first drive has" : "this one has") + " none that fixes its place");
  Rigid3 site_from_odom;
  if (outcome.gnss) {
    map.datum = outcome.gnss->datum;
    site_from_odom = outcome.gnss->site_from_odom;
  }
  drive.site_from_body_trajectory = odom_from_body.Transformed(site_from_odom);
  for (Submap& submap : submaps) {
    const Timestamp begin = submap.keyframes.front().time;
    const Rigid3 correction = *odom_from_body.At(begin) * drive.odometry.At(begin)->Inverse();
    const Rigid3 site_from_submap = site_from_odom * correction * submap.odom_from_submap;
    map.submaps.push_back({std::move(submap), site_from_submap});
  }
}

/// What all drives saw of the ground, and where they drove, in the site.
struct SiteGround {
  std::vector<PosedGroundPatch> patches;
  std::vector<DrivenPath> paths;
};

void ObserveGroundOf(const DriveLog& log, int drive, const GroundOptions& options, BuiltMap& built,
                     SiteGround& ground) {
  std::vector<Submap> submaps;
  for (const PosedSubmap& posed : built.site.submaps)
    if (posed.submap.drive == drive) submaps.push_back(posed.submap);
  const SiteDrive& site_drive = built.site.drives[static_cast<size_t>(drive)];
  GroundObservation seen = ObserveGround(log, site_drive.odometry, submaps, drive, options);
  built.drives[static_cast<size_t>(drive)].num_ground_images = seen.num_images;
  std::move(seen.warnings.begin(), seen.warnings.end(), std::back_inserter(built.warnings));

  const Trajectory& site_from_body = site_drive.site_from_body_trajectory;
  ground.paths.push_back(MakeDrivenPath(drive, site_drive.rig, site_from_body, seen.body_from_ground));
  for (GroundPatch& patch : seen.patches)
    if (const std::optional<Rigid3> pose = site_from_body.At(patch.time))
      ground.patches.push_back({std::move(patch), *pose});
}

constexpr const char* kOdometryFile = "odometry.bin";

OdometryResult ReadStoredOdometry(const DriveLog& log, const std::filesystem::path& map) {
  const std::filesystem::path file = map / log.name() / kOdometryFile;
  Require(std::filesystem::exists(file), ErrorCode::kInvalidInput,
          "the map to start from holds no odometry of drive '" + log.name() + "'");
  OdometryResult odometry = ReadOdometry(file, log.rig());
  const TimeSpan stored = odometry.odom_from_body.span(), recorded = log.span();
  Require(recorded.Contains(stored.begin) && recorded.Contains(stored.end), ErrorCode::kInvalidInput,
          "the odometry of drive '" + log.name() + "' in the map to start from is of another log");
  return odometry;
}

void StoreOdometry(const OdometryResult& odometry, const std::string& drive, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder / drive);
  WriteOdometry(odometry, folder / drive / kOdometryFile);
}

}  // namespace

std::vector<StagePlan> PlanStages(size_t num_drives, bool is_odometry_only) {
  // Weights are shares of the time that a typical drive takes.
  const double drives = static_cast<double>(num_drives);
  std::vector<StagePlan> plan = {
      {"track", 70 * drives}, {"close loops", 15 * drives}, {"refine", 10 * drives}, {"place on earth", 2 * drives}};
  if (!is_odometry_only)
    plan.insert(plan.end(), {{"observe ground", 15 * drives},
                             {"fuse surface", 5 * drives},
                             {"mesh", 4 * drives},
                             {"texture", 15 * drives}});
  plan.push_back({"write", 4});
  return plan;
}

BuiltMap BuildMap(const std::vector<std::unique_ptr<RecordedDrive>>& logs, const MapOptions& options,
                  const BuildScope& scope, Progress& progress) {
  BuiltMap built;
  SiteMap& map = built.site;
  const auto share_of_drive = [&](size_t i) {
    return [&progress, i, n = static_cast<double>(logs.size())](double fraction) {
      progress.Update((static_cast<double>(i) + fraction) / n);
    };
  };

  progress.Begin("track");
  std::vector<OdometryResult> odometry;
  for (size_t i = 0; i < logs.size(); ++i) {
    odometry.push_back(scope.from.empty() ? EstimateTrajectory(*logs[i], options.odometry, share_of_drive(i))
                                          : ReadStoredOdometry(*logs[i], scope.from));
    if (!scope.products.empty()) StoreOdometry(odometry[i], logs[i]->name(), scope.products);
  }

  progress.Begin("close loops");
  for (size_t i = 0; i < logs.size(); ++i) {
    // Cameras are where and when odometry found them to be.
    const CalibratedLog calibrated(*logs[i], odometry[i].rig);
    const Trajectory& odom_from_body = odometry[i].odom_from_body;
    DriveOutcome& outcome = built.drives.emplace_back();
    outcome.odometry = odometry[i].report;
    outcome.num_keyframes = odometry[i].keyframes.size();
    const auto review = scope.loops.find(logs[i]->name());
    outcome.loops = CloseLoops(calibrated, odom_from_body, options.loops,
                               review == scope.loops.end() ? LoopReview{} : review->second);
    share_of_drive(i)(1);
  }

  progress.Begin("refine");
  std::vector<CalibratedLog> drives;  // as all that follows sees them
  for (size_t i = 0; i < logs.size(); ++i) {
    DriveOutcome& outcome = built.drives[i];
    outcome.refinement = RefineDrive(odometry[i], logs[i]->rig(), outcome.loops, options.refinement);
    odometry[i].measurements.reset();
    drives.emplace_back(*logs[i], outcome.refinement.rig);
    map.drives.push_back({drives[i].name(), drives[i].rig(), odometry[i].odom_from_body, {}});
    share_of_drive(i)(1);
  }

  progress.Begin("place on earth");
  for (size_t i = 0; i < logs.size(); ++i) {
    std::vector<Submap> submaps = CutIntoSubmaps(odometry[i], static_cast<int>(i), options.submaps);
    PlaceOnEarth(*logs[i], i, options.gnss, map, built.drives[i], std::move(submaps));
  }
  if (scope.is_odometry_only) return built;

  progress.Begin("observe ground");
  SiteGround ground;
  for (size_t i = 0; i < logs.size(); ++i) {
    ObserveGroundOf(drives[i], static_cast<int>(i), options.ground, built, ground);
    share_of_drive(i)(1);
  }

  progress.Begin("fuse surface");
  map.surface = FuseSurface(ground.patches, ground.paths, options.surface);

  progress.Begin("mesh");
  map.mesh = MeshSurface(map.surface, options.mesh);
  if (map.mesh.empty()) built.warnings.push_back("no ground was found: the map holds trajectories only");

  progress.Begin("texture");
  std::vector<TextureSource> sources;
  for (size_t i = 0; i < logs.size(); ++i) sources.push_back({&drives[i], &ground.paths[i]});
  map.texture = PaintTexture(map.mesh, map.surface, sources, options.texture);
  return built;
}

}  // namespace parkade
