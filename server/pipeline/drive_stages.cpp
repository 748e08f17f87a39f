#include "server/pipeline/drive_stages.h"

#include <nlohmann/json.hpp>

#include "core/binary_archive.h"
#include "core/options_json.h"
#include "core/sha256.h"
#include "core/version.h"
#include "mapping/networks/builtin_network.h"
#include "server/map_folder/heights_file.h"
#include "slam/odometry/calibrated_log.h"
#include "slam/sessions/stage_results.h"

namespace parkade {
namespace {

template <typename Options>
std::string TextOf(const Options& options) {
  return OptionsToJson(options).dump();
}

std::string TextOf(const LoopReview& review) { return nlohmann::json{review.rejected, review.forced}.dump(); }

constexpr const char* kPlacesFile = "/places.bin";

// Numbers with every bit, as they are in memory.

std::string BytesOf(GnssPositions gnss) {
  BinaryWriter writer;
  writer(gnss.antenna_in_body);
  for (GnssFix& fix : gnss.fixes) writer(fix.time.ns, fix.latitude_deg, fix.longitude_deg, fix.altitude, fix.sigma_enu);
  return writer.bytes();
}

std::string BytesOf(const std::optional<GnssAlignment>& gnss) {
  BinaryWriter writer;
  if (gnss) {
    GnssAlignment alignment = *gnss;
    writer(alignment.site_from_odom.rotation, alignment.site_from_odom.translation, alignment.covariance,
           alignment.extent);
  }
  return writer.bytes();
}

/// Of what the refinement may change about a rig: the rest belongs to the odometry.
std::string BytesOf(Rig rig) {
  BinaryWriter writer;
  for (RigCamera& camera : rig.cameras)
    writer(camera.body_from_camera.rotation, camera.body_from_camera.translation, camera.time_shift, camera.line_delay);
  return writer.bytes();
}

}  // namespace

DriveStages::DriveStages(const std::filesystem::path& from, std::filesystem::path to, const MapOptions& options)
    : from_(from), to_(to), products_(from, std::move(to)), options_(options) {}

void DriveStages::Begin(const DriveLog& log, const std::filesystem::path& odometry_file) {
  const std::string odometry = odometry_file.empty() ? "" : Sha256OfFile(odometry_file);
  const std::string key = KeyOf({kVersion, std::to_string(kStageResultsVersion), odometry});
  keys_[log.name()] = {.odometry = key, .ground = {}, .refinement = {}, .so_far = key};
}

LoopClosure DriveStages::CloseLoops(const DriveLog& log, const OdometryResult& odometry, const LoopReview& review) {
  std::string& key = keys_.at(log.name()).so_far;
  key = KeyOf({key, "loops", TextOf(options_.loops), TextOf(review)});
  double seconds = 0;
  const std::string bytes = products_.Get(log.name() + "/loops.bin", key, [&] {
    // Cameras are where and when odometry found them to be.
    const LoopClosure loops =
        parkade::CloseLoops(CalibratedLog(log, odometry.rig), odometry.odom_from_body, options_.loops, review);
    seconds = loops.seconds;
    return EncodeLoops(loops);
  });
  LoopClosure loops = DecodeLoops(bytes);
  loops.seconds = seconds;
  return loops;
}

DriveRefinement DriveStages::Refine(const DriveLog& log, const OdometryResult& odometry, const LoopClosure& loops) {
  const GnssPositions gnss = ReadGnss(log, options_.gnss);
  std::string& key = keys_.at(log.name()).so_far;
  key = KeyOf({key, "refinement", TextOf(options_.refinement), TextOf(options_.gnss), BytesOf(gnss)});
  keys_.at(log.name()).refinement = key;
  double seconds = 0;
  const std::string bytes = products_.Get(log.name() + "/refinement.bin", key, [&] {
    const DriveRefinement refinement = RefineDrive(odometry, log.rig(), loops, options_.refinement, gnss);
    seconds = refinement.seconds;
    return EncodeRefinement(refinement);
  });
  DriveRefinement refinement = DecodeRefinement(bytes, odometry.rig);
  refinement.seconds = seconds;
  return refinement;
}

std::vector<Place> DriveStages::FindPlaces(const DriveLog& log, const OdometryResult& odometry,
                                           const DriveRefinement& refinement) {
  const std::string bytes = products_.Get(log.name() + kPlacesFile, KeyOfPlaces(log), [&] {
    std::string encoded;
    EncodePlacesAlong(log, odometry, refinement, [&encoded](std::string_view piece) { encoded += piece; });
    return encoded;
  });
  return DecodePlaces(bytes);
}

void DriveStages::KeepPlaces(const DriveLog& log, const OdometryResult& odometry, const DriveRefinement& refinement) {
  products_.Keep(log.name() + kPlacesFile, KeyOfPlaces(log),
                 [&](const PieceSink& sink) { EncodePlacesAlong(log, odometry, refinement, sink); });
}

std::string DriveStages::KeyOfPlaces(const DriveLog& log) {
  std::string& key = keys_.at(log.name()).so_far;
  key = KeyOf({key, "places"});
  return key;
}

void DriveStages::EncodePlacesAlong(const DriveLog& log, const OdometryResult& odometry,
                                    const DriveRefinement& refinement, const PieceSink& sink) const {
  const Trajectory& odom_from_body = refinement.odom_from_body;
  const PlaceOptions& options = options_.loops.places;
  std::vector<Place> places = PlacesAlong(odometry.odom_from_body, odom_from_body, options);
  PlacesEncoder encoder(places.size(), sink);
  const std::vector<bool> all(places.size(), true);
  DescribePlaces(log, odom_from_body, options, all, std::move(places),
                 [&encoder](Place&& place) { encoder.Add(std::move(place)); });
  encoder.Finish();
}

std::shared_ptr<const GroundFile> DriveStages::ObserveGround(const DriveLog& log, const OdometryResult& odometry,
                                                             std::span<const Submap> drive_submaps) {
  Require(!to_.empty(), ErrorCode::kInternal, "what is seen of the ground needs a folder to lie in");
  const std::string& model = options_.ground.freespace_model;
  std::string& key = keys_.at(log.name()).ground;
  key = KeyOf({keys_.at(log.name()).odometry, "ground", std::to_string(kGroundVersion), BytesOf(log.rig()),
               TextOf(options_.ground), TextOf(options_.submaps),
               model.empty() ? KeyOf({std::string(BuiltinFreespaceNetwork()), std::string(BuiltinLevelNetwork())})
                             : Sha256OfFile(model)});
  const std::filesystem::path name = std::filesystem::path(log.name()) / "ground.bin", file = to_ / name;
  if (!from_.empty())
    if (std::shared_ptr<const GroundFile> taken = GroundFile::Open(from_ / name, key)) {
      LinkOrCopy(from_ / name, file);
      return taken;
    }
  GroundFileWriter writer(file, key);
  writer.Finish(parkade::ObserveGround(log, odometry.odom_from_body, drive_submaps, 0, options_.ground,
                                       [&](GroundPatch&& patch) { writer.Add(patch); }));
  std::shared_ptr<const GroundFile> written = GroundFile::Open(file, key);
  Require(written != nullptr, ErrorCode::kInternal, "'" + file.string() + "' cannot be read again");
  return written;
}

DriveHeights DriveStages::MeasureHeights(const DriveLog& log, const std::shared_ptr<const GroundFile>& ground,
                                         const DriveRefinement& refinement, int drive) {
  const HeightOptions options = options_.surface.Heights();
  const Keys& keys = keys_.at(log.name());
  const std::string key = KeyOf({keys.ground, keys.refinement, "heights", TextOf(options)});
  const std::string bytes = products_.Get(log.name() + "/heights.bin", key, [&] {
    StoredGround patches;
    patches.Add(ground, 0, refinement.odom_from_body);
    const DrivenPath path =
        MakeDrivenPath(0, log.rig(), refinement.odom_from_body, ground->observation().body_from_ground);
    return EncodeHeights(MeasureDriveHeights(patches, &path, options));
  });
  DriveHeights heights = DecodeHeights(bytes);
  heights.drive = drive;
  return heights;
}

PairMemory DriveStages::MemoryOfPairs(const std::vector<std::string>& names,
                                      const std::vector<DriveToJoin>& drives) const {
  return
      [this, names, &drives](const std::string& what, size_t a, size_t b, const std::function<std::string()>& compute) {
        const std::string key = KeyOf({what, keys_.at(names[a]).so_far, keys_.at(names[b]).so_far,
                                       TextOf(options_.links), BytesOf(drives[a].gnss), BytesOf(drives[b].gnss)});
        return products_.Get(names[b] + "/" + what + ".bin", key, compute);
      };
}

}  // namespace parkade
