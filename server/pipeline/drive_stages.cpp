#include "server/pipeline/drive_stages.h"

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/error.h"
#include "core/files/binary_archive.h"
#include "core/files/sha256.h"
#include "core/options_json.h"
#include "mapping/heights/moved_heights.h"
#include "mapping/heights/path_agreement.h"
#include "mapping/networks/builtin_network.h"
#include "server/map_folder/heights_file.h"
#include "server/pipeline/kept_odometry.h"
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

constexpr const char *kKeyframesFile = "/places.bin", *kWordsFile = "/words.bin";

// Text with every bit of the numbers, as they are in memory.

std::string BytesOf(GnssPositions gnss) {
  BinaryWriter writer;
  writer(gnss.antenna_in_body);
  for (GnssFix& fix : gnss.fixes)
    writer(fix.time.ns, fix.latitude_deg, fix.longitude_deg, fix.altitude, fix.sigma_enu);
  return writer.bytes();
}

std::string BytesOf(std::vector<CameraPlacement> placements) {
  BinaryWriter writer;
  for (CameraPlacement& camera : placements)
    writer(camera.body_from_camera.rotation, camera.body_from_camera.translation, camera.time_shift,
           camera.line_delay);
  return writer.bytes();
}

std::string BytesOf(const std::vector<TimedPose>& poses) {
  BinaryWriter writer;
  for (TimedPose pose : poses)
    writer(pose.time.ns, pose.world_from_frame.rotation, pose.world_from_frame.translation);
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

/// The drive is refined.
DriveResiduals ResidualsOf(const BuildContext& context, DriveInWork& drive) {
  const StageFile<DriveResiduals> file{drive.log->name() + "/residuals.bin", EncodeResiduals,
                                       DecodeResiduals};
  return Cached(context.cache, file, KeyOf({drive.refinement.key, "residuals"}),
                [&] {
                  LoadMeasurements(context.scope, *drive.log, drive.odometry.value);
                  return MeasureResiduals(drive.odometry.value, drive.log->rig(),
                                          drive.refinement.value, context.options.refinement);
                })
      .value;
}

std::string KeyOfKeyframes(const DriveInWork& drive) {
  return KeyOf({drive.refinement.key, "places", std::to_string(kKeyframesVersion)});
}

/// Keyframes are described by the odometry, as for loops, and only where loops did not do so
/// before; then they are taken to the refined drive. Returns their words.
PlaceWords EncodeKeyframesAlong(const BuildContext& context, const DriveInWork& drive,
                                const PieceSink& sink) {
  const OdometryResult& odometry = drive.odometry.value;
  const DriveRefinement& refinement = drive.refinement.value;
  const KeyframeOptions& options = context.options.loops.keyframes;
  std::vector<RigKeyframe> moved =
      KeyframesAlong(odometry.odom_from_body, refinement.odom_from_body, options);
  PlaceWords words;
  KeyframesEncoder encoder(moved.size(), sink);
  KeyframeMover mover({odometry.odom_from_body, odometry.rig},
                      {refinement.odom_from_body, drive.calibrated->rig()}, std::move(moved),
                      options, [&](RigKeyframe&& keyframe) {
                        words.Add(keyframe);
                        encoder.Add(std::move(keyframe));
                      });
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
  return words;
}

StageFile<PlaceWords> WordsFileOf(const DriveInWork& drive) {
  return {drive.log->name() + kWordsFile,
          [](PlaceWords words) {
            BinaryWriter writer;
            writer(words);
            return std::move(writer).Take();
          },
          [](std::string_view bytes) {
            PlaceWords words;
            BinaryReader{bytes}(words);
            return words;
          }};
}

/// Found once: networks are megabytes, and a site asks for each of its drives.
const std::string& KeyOfBuiltinNetworks() {
  static const std::string key =
      KeyOf({std::string(BuiltinFreespaceNetwork()), std::string(BuiltinLevelNetwork())});
  return key;
}

/// The first half of a key of heights says what they are of and how they were found, the other
/// along which paths.
std::string KeyOfHeights(const std::string& first_half, const std::string& along) {
  return first_half + KeyOf({along}).substr(0, first_half.size());
}

/// Heights of the same ground in the map to start from.
std::optional<Keyed<DriveHeights>> EarlierHeights(const StageCache& cache, const std::string& file,
                                                  const std::string& first_half) {
  const auto last = cache.LastOfMap(file);
  if (!last || !last->first.starts_with(first_half)) return std::nullopt;
  return Keyed<DriveHeights>{DecodeHeights(last->second), last->first};
}

}  // namespace

void CloseLoops(const BuildContext& context, DriveInWork& drive) {
  drive.review = ReviewFor(drive, context);
  const std::string key = KeyOf({drive.odometry.key, "loops", std::to_string(kKeyframesVersion),
                                 TextOf(context.options.loops), TextOf(drive.review)});
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
    LoadMeasurements(context.scope, *drive.log, odometry);
    return RefineDrive(odometry, drive.log->rig(), drive.loops.value, context.options.refinement,
                       gnss);
  });
  drive.diagnostics = {odometry.keyframes, ResidualsOf(context, drive), gnss};
  odometry.measurements.reset();
  drive.calibrated.emplace(*drive.log, drive.refinement.value.rig);
}

void DescribeKeyframes(const BuildContext& context, DriveInWork& drive) {
  const std::string file = drive.log->name() + kKeyframesFile, key = KeyOfKeyframes(drive);
  const StageFile<PlaceWords> words_file = WordsFileOf(drive);
  const auto encode = [&context, &drive] {
    std::string encoded;
    EncodeKeyframesAlong(context, drive, [&encoded](std::string_view piece) { encoded += piece; });
    return encoded;
  };
  DriveKeyframes& found = drive.keyframes;
  found.key = key;
  if (context.cache.MapHas(words_file.name, key) && context.cache.ShareUnread(file, key)) {
    found.keyframes =
        KeyframesAlong(drive.odometry.value.odom_from_body, drive.refinement.value.odom_from_body,
                       context.options.loops.keyframes);
    found.describe = [&context, file, key, encode] {
      return DecodeKeyframes(context.cache.ReadShared(file, key, encode));
    };
  } else {
    found.keyframes = DecodeKeyframes(context.cache.Get(file, key, encode));
    drive.described.reset();
  }
  found.words = Cached(context.cache, words_file, key, [&found] {
                  return PlaceWords(found.describe ? found.describe() : found.keyframes);
                }).value;
}

void KeepKeyframes(const BuildContext& context, DriveInWork& drive) {
  const std::string file = drive.log->name() + kKeyframesFile, key = KeyOfKeyframes(drive);
  const StageFile<PlaceWords> words_file = WordsFileOf(drive);
  std::optional<PlaceWords> words;
  context.cache.Keep(file, key, [&](const PieceSink& sink) {
    words = EncodeKeyframesAlong(context, drive, sink);
  });
  if (words)
    Cached(context.cache, words_file, key, [&words] { return *words; });
  else if (const std::optional<std::string> known = context.cache.Find(words_file.name, key))
    context.cache.Get(words_file.name, key, [&known] { return *known; });
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
  const std::string key =
      KeyOf({drive.odometry.key, "ground", std::to_string(kGroundVersion), TextOf(options), model});
  const std::vector<CameraPlacement> placements = PlacementsOf(log.rig());
  const auto keyed = [&key](std::shared_ptr<const GroundFile> seen) {
    const std::string bytes = BytesOf(seen->observation().placements);
    return Keyed<std::shared_ptr<const GroundFile>>{std::move(seen), KeyOf({key, bytes})};
  };
  const std::string name = log.name() + "/ground.bin";
  const std::filesystem::path file = to / name;
  // What an unfinished build left may be of other decisions, and the map does not depend on it.
  const auto is_seen_alike = [&](const std::filesystem::path& source,
                                 const std::vector<CameraPlacement>& before) {
    return source == context.scope.from ? SeeAlike(before, placements)
                                        : BytesOf(before) == BytesOf(placements);
  };
  for (const std::filesystem::path& source : context.cache.sources())
    if (std::shared_ptr<const GroundFile> taken = GroundFile::Open(source / name, key);
        taken && is_seen_alike(source, taken->observation().placements)) {
      LinkOrCopy(source / name, file);
      return keyed(std::move(taken));
    }
  GroundFileWriter writer(file, key);
  const OdometryResult& odometry = drive.odometry.value;
  writer.Finish(ObserveGround(log, odometry.odom_from_body, odometry.landmarks, 0, options,
                              [&](GroundPatch&& patch) { writer.Add(patch); }));
  std::shared_ptr<const GroundFile> written = GroundFile::Open(file, key);
  Require(written != nullptr, ErrorCode::kInternal, "'" + file.string() + "' cannot be read again");
  context.cache.Share(name);
  return keyed(std::move(written));
}

Keyed<DriveHeights> MeasureHeights(const BuildContext& context, const DriveInWork& drive,
                                   const Keyed<std::shared_ptr<const GroundFile>>& ground,
                                   int number) {
  const HeightOptions options = context.options.surface.Heights();
  const Trajectory& odom_from_body = drive.refinement.value.odom_from_body;
  const StageFile<DriveHeights> file{drive.log->name() + "/heights.bin", EncodeHeights,
                                     DecodeHeights};
  const std::string first_half =
      KeyOf({ground.key, "heights", std::to_string(kHeightsVersion)}).substr(0, 32);
  const std::string along = BytesOf(SparsePoses(odom_from_body));
  std::string key = KeyOfHeights(first_half, along);
  std::optional<Keyed<DriveHeights>> earlier;
  std::optional<MovedHeights> moved;
  if (!context.cache.MapHas(file.name, key))
    earlier = EarlierHeights(context.cache, file.name, first_half);
  if (earlier) moved = FindMovedHeights(earlier->value, odom_from_body, options);
  const HeightsWorth worth = moved ? moved->worth : HeightsWorth::kNone;
  if (worth == HeightsWorth::kHold) key = earlier->key;
  if (worth == HeightsWorth::kSome) key = KeyOfHeights(first_half, earlier->key + along);
  Keyed<DriveHeights> heights = Cached(context.cache, file, key, [&] {
    StoredGround patches;
    patches.Add(ground.value, 0, odom_from_body);
    const DrivenPath path = MakeDrivenPath(0, drive.calibrated->rig(), odom_from_body,
                                           ground.value->observation().body_from_ground);
    return worth == HeightsWorth::kSome
               ? MeasureMovedHeights(patches, path, options, earlier->value, moved->squares)
               : MeasureDriveHeights(patches, &path, options);
  });
  heights.value.drive = number;
  return heights;
}

}  // namespace parkade
