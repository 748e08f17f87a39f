#include "server/drive_stages.h"

#include <nlohmann/json.hpp>

#include "core/options_json.h"
#include "server/store/durable_file.h"
#include "server/version.h"
#include "slam/binary_archive.h"
#include "slam/calibrated_log.h"
#include "slam/stage_results.h"

namespace parkade {
namespace {

template <typename Options>
std::string TextOf(const Options& options) {
  return OptionsToJson(options).dump();
}

std::string TextOf(const LoopReview& review) { return nlohmann::json{review.rejected, review.forced}.dump(); }

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

}  // namespace

DriveStages::DriveStages(const std::filesystem::path& from, std::filesystem::path to, const MapOptions& options)
    : products_(from, std::move(to)), options_(options) {}

void DriveStages::Begin(const DriveLog& log, const std::filesystem::path& odometry_file) {
  const std::string odometry = odometry_file.empty() ? "" : Sha256OfFile(odometry_file);
  keys_[log.name()] = KeyOf({kVersion, std::to_string(kStageResultsVersion), odometry});
}

LoopClosure DriveStages::CloseLoops(const DriveLog& log, const OdometryResult& odometry, const LoopReview& review) {
  std::string& key = keys_.at(log.name());
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
  std::string& key = keys_.at(log.name());
  key = KeyOf({key, "refinement", TextOf(options_.refinement), TextOf(options_.gnss), BytesOf(gnss)});
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
  std::string& key = keys_.at(log.name());
  key = KeyOf({key, "places"});
  const std::string bytes = products_.Get(log.name() + "/places.bin", key, [&] {
    return EncodePlaces(PlacesAlong(log, odometry.odom_from_body, refinement.odom_from_body, options_.loops.places));
  });
  return DecodePlaces(bytes);
}

PairMemory DriveStages::MemoryOfPairs(const std::vector<std::string>& names,
                                      const std::vector<DriveToJoin>& drives) const {
  return
      [this, names, &drives](const std::string& what, size_t a, size_t b, const std::function<std::string()>& compute) {
        const std::string key = KeyOf({what, keys_.at(names[a]), keys_.at(names[b]), TextOf(options_.links),
                                       BytesOf(drives[a].gnss), BytesOf(drives[b].gnss)});
        return products_.Get(names[b] + "/" + what + ".bin", key, compute);
      };
}

}  // namespace parkade
