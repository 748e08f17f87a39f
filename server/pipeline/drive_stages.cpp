#include "server/pipeline/drive_stages.h"

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files/binary_archive.h"
#include "core/files/sha256.h"
#include "core/options_json.h"
#include "mapping/networks/builtin_network.h"
#include "server/map_folder/heights_file.h"
#include "slam/georeference/gnss_doubts.h"
#include "slam/loops/close_loops.h"
#include "slam/places/describe_keyframes.h"
#include "slam/places/keyframe_bytes.h"
#include "slam/places/move_keyframes.h"
#include "slam/sessions/stage_results.h"

namespace parkade {
namespace {

template <typename Options>
std::string TextOf(const Options& options) {
  return OptionsToJson(options).dump();
}

std::string TextOf(const LoopReview& review) {
  return nlohmann::json{review.rejected, review.forced}.dump();
}

constexpr const char* kKeyframesFile = "/places.bin";

// Text with every bit of the numbers, as they are in memory.

std::string BytesOf(GnssPositions gnss) {
  BinaryWriter writer;
  writer(gnss.antenna_in_body);
  for (GnssFix& fix : gnss.fixes)
    writer(fix.time.ns, fix.latitude_deg, fix.longitude_deg, fix.altitude, fix.sigma_enu);
  return writer.bytes();
}

/// Hash of everything that the refinement may change about a rig: the rest belongs to the odometry.
std::string BytesOf(Rig rig) {
  BinaryWriter writer;
  for (RigCamera& camera : rig.cameras)
    writer(camera.body_from_camera.rotation, camera.body_from_camera.translation, camera.time_shift,
           camera.line_delay);
  return writer.bytes();
}

/// The decisions of this build and, of the one that it starts from, those that it does not
/// overrule. Keyframes, by which loops are called, are those of the odometry.
LoopReview ReviewFor(const DriveInWork& drive, const BuildContext& context) {
  LoopReview review;
  if (const auto own = context.scope.loops.find(drive.log->name());
      own != context.scope.loops.end())
    review = own->second;
  if (!drive.is_odometry_taken) return review;
  const LoopReview now = review, before = context.from->ReviewOf(drive.log->name());
  const auto has = [](const std::vector<std::string>& loops, const std::string& loop) {
    return std::find(loops.begin(), loops.end(), loop) != loops.end();
  };
  const auto is_new = [&](const std::string& loop) {
    return !has(now.rejected, loop) && !has(now.forced, loop);
  };
  std::copy_if(before.rejected.begin(), before.rejected.end(), std::back_inserter(review.rejected),
               is_new);
  std::copy_if(before.forced.begin(), before.forced.end(), std::back_inserter(review.forced),
               is_new);
  return review;
}

/// The drive is refined, and has its measurements still.
DriveResiduals ResidualsOf(const BuildContext& context, const DriveInWork& drive) {
  const StageFile<DriveResiduals> file{drive.log->name() + "/residuals.bin", EncodeResiduals,
                                       DecodeResiduals};
  return Cached(context.cache, file, KeyOf({drive.refinement.key, "residuals"}),
                [&] {
                  return MeasureResiduals(drive.odometry.value, drive.log->rig(),
                                          drive.refinement.value, context.options.refinement);
                })
      .value;
}

std::string KeyOfKeyframes(const DriveInWork& drive) {
  return KeyOf({drive.refinement.key, "places"});
}

/// Keyframes are described by the odometry, as for loops, and only where loops did not do so
/// before; then they are taken to the refined drive.
void EncodeKeyframesAlong(const BuildContext& context, const DriveInWork& drive,
                          const PieceSink& sink) {
  const OdometryResult& odometry = drive.odometry.value;
  const DriveRefinement& refinement = drive.refinement.value;
  const KeyframeOptions& options = context.options.loops.keyframes;
  std::vector<RigKeyframe> moved =
      KeyframesAlong(odometry.odom_from_body, refinement.odom_from_body, options);
  KeyframesEncoder encoder(moved.size(), sink);
  KeyframeMover mover({odometry.odom_from_body, odometry.rig},
                      {refinement.odom_from_body, drive.calibrated->rig()}, std::move(moved),
                      options, [&](RigKeyframe&& keyframe) { encoder.Add(std::move(keyframe)); });
  const KeyframeStore& described = *drive.described;
  std::vector<RigKeyframe> chosen = ChooseKeyframes(odometry.odom_from_body, options);
  std::vector<bool> is_missing;
  is_missing.reserve(chosen.size());
  for (const RigKeyframe& keyframe : chosen) is_missing.push_back(!described.Has(keyframe.time));
  DescribeKeyframes(CalibratedLog(*drive.log, odometry.rig), odometry.odom_from_body, options,
                    is_missing, std::move(chosen), [&](RigKeyframe&& keyframe) {
                      std::optional<RigKeyframe> known = described.Find(keyframe.time);
                      mover.Add(known ? std::move(*known) : std::move(keyframe));
                    });
  encoder.Finish();
}

/// Found once: networks are megabytes, and a site asks for each of its drives.
const std::string& KeyOfBuiltinNetworks() {
  static const std::string key =
      KeyOf({std::string(BuiltinFreespaceNetwork()), std::string(BuiltinLevelNetwork())});
  return key;
}

}  // namespace

void CloseLoops(const BuildContext& context, DriveInWork& drive) {
  drive.review = ReviewFor(drive, context);
  const std::string key =
      KeyOf({drive.odometry.key, "loops", TextOf(context.options.loops), TextOf(drive.review)});
  const StageFile<LoopClosure> file{drive.log->name() + "/loops.bin", EncodeLoops, DecodeLoops};
  drive.described = std::make_shared<KeyframeStore>();
  drive.loops = Cached(context.cache, file, key, [&] {
    // Cameras are where and when odometry found them to be.
    const OdometryResult& odometry = drive.odometry.value;
    return CloseLoops(CalibratedLog(*drive.log, odometry.rig), odometry.odom_from_body,
                      context.options.loops, drive.review, *drive.described);
  });
}

void Refine(const BuildContext& context, DriveInWork& drive) {
  GnssPositions gnss = ReadGnss(*drive.log, context.options.gnss);
  OdometryResult& odometry = drive.odometry.value;
  std::string& doubt = drive.gnss_verdict.doubt;
  doubt = DoubtOfFixes(odometry.odom_from_body, gnss.fixes, gnss.options.max_fix_sigma);
  if (!doubt.empty()) gnss.fixes.clear();
  const std::string key = KeyOf({drive.loops.key, "refinement", TextOf(context.options.refinement),
                                 TextOf(context.options.gnss), BytesOf(gnss)});
  const StageFile<DriveRefinement> file{
      drive.log->name() + kRefinementFile, EncodeRefinement,
      [&](std::string_view bytes) { return DecodeRefinement(bytes, odometry.rig); }};
  drive.refinement = Cached(context.cache, file, key, [&] {
    return RefineDrive(odometry, drive.log->rig(), drive.loops.value, context.options.refinement,
                       gnss);
  });
  drive.diagnostics = {odometry.keyframes, ResidualsOf(context, drive), gnss};
  odometry.measurements.reset();
  drive.calibrated.emplace(*drive.log, drive.refinement.value.rig);
}

void DescribeKeyframes(const BuildContext& context, DriveInWork& drive) {
  drive.keyframes.key = KeyOfKeyframes(drive);
  const std::string bytes =
      context.cache.Get(drive.log->name() + kKeyframesFile, drive.keyframes.key, [&] {
        std::string encoded;
        EncodeKeyframesAlong(context, drive,
                             [&encoded](std::string_view piece) { encoded += piece; });
        return encoded;
      });
  drive.keyframes.value = DecodeKeyframes(bytes);
  drive.described.reset();
}

void KeepKeyframes(const BuildContext& context, DriveInWork& drive) {
  context.cache.Keep(drive.log->name() + kKeyframesFile, KeyOfKeyframes(drive),
                     [&](const PieceSink& sink) { EncodeKeyframesAlong(context, drive, sink); });
  drive.described.reset();
}

Keyed<std::shared_ptr<const GroundFile>> ObserveGround(const BuildContext& context,
                                                       const DriveInWork& drive) {
  const std::filesystem::path& to = context.scope.products;
  Require(!to.empty(), ErrorCode::kInternal, "what is seen of the ground needs a folder to lie in");
  const GroundOptions& options = context.options.ground;
  const DriveLog& log = *drive.calibrated;
  const std::string model = options.freespace_model.empty() ? KeyOfBuiltinNetworks()
                                                            : Sha256OfFile(options.freespace_model);
  const std::string key = KeyOf({drive.odometry.key, "ground", std::to_string(kGroundVersion),
                                 BytesOf(log.rig()), TextOf(options), model});
  const std::string name = log.name() + "/ground.bin";
  const std::filesystem::path file = to / name;
  for (const std::filesystem::path& source : context.cache.sources())
    if (std::shared_ptr<const GroundFile> taken = GroundFile::Open(source / name, key)) {
      LinkOrCopy(source / name, file);
      return {taken, key};
    }
  GroundFileWriter writer(file, key);
  const OdometryResult& odometry = drive.odometry.value;
  writer.Finish(ObserveGround(log, odometry.odom_from_body, odometry.landmarks, 0, options,
                              [&](GroundPatch&& patch) { writer.Add(patch); }));
  std::shared_ptr<const GroundFile> written = GroundFile::Open(file, key);
  Require(written != nullptr, ErrorCode::kInternal, "'" + file.string() + "' cannot be read again");
  context.cache.Share(name);
  return {written, key};
}

Keyed<DriveHeights> MeasureHeights(const BuildContext& context, const DriveInWork& drive,
                                   const Keyed<std::shared_ptr<const GroundFile>>& ground,
                                   int number) {
  const HeightOptions options = context.options.surface.Heights();
  const std::string key = KeyOf({ground.key, drive.refinement.key, "heights"});
  const StageFile<DriveHeights> file{drive.log->name() + "/heights.bin", EncodeHeights,
                                     DecodeHeights};
  Keyed<DriveHeights> heights = Cached(context.cache, file, key, [&] {
    const Trajectory& odom_from_body = drive.refinement.value.odom_from_body;
    StoredGround patches;
    patches.Add(ground.value, 0, odom_from_body);
    const DrivenPath path = MakeDrivenPath(0, drive.calibrated->rig(), odom_from_body,
                                           ground.value->observation().body_from_ground);
    return MeasureDriveHeights(patches, &path, options);
  });
  heights.value.drive = number;
  return heights;
}

}  // namespace parkade
