#include "server/pipeline/kept_pairs.h"

#include <map>
#include <optional>
#include <utility>

#include "core/files/binary_archive.h"
#include "core/options_json.h"
#include "slam/sessions/stage_results.h"

namespace parkade {
namespace {

/// What is known about a drive and an earlier one.
struct FoundPair {
  std::optional<double> similarity;
  std::optional<std::string> links;  ///< EncodeLinks
};

template <typename Archive>
void Serialize(Archive& archive, FoundPair& pair) {
  archive(pair.similarity, pair.links);
}

/// The pairs of one drive.
struct FoundPairs {
  std::string key;                           ///< of the drive
  std::map<std::string, FoundPair> earlier;  ///< by the key of the other one
};

template <typename Archive>
void Serialize(Archive& archive, FoundPairs& pairs) {
  archive(pairs.key, pairs.earlier);
}

/// Every bit of the numbers, as they are in memory.
std::string BytesOf(const std::optional<GnssAlignment>& gnss) {
  BinaryWriter writer;
  if (gnss) {
    GnssAlignment alignment = *gnss;
    writer(alignment.site_from_odom.rotation, alignment.site_from_odom.translation,
           alignment.covariance, alignment.extent);
  }
  return writer.bytes();
}

}  // namespace

KeptPairs::KeptPairs(const BuildContext& context, const std::vector<DriveInWork>& drives)
    : context_(context), drives_(drives) {
  const std::string options = OptionsToJson(context.options.links).dump();
  for (const DriveInWork& drive : drives)
    keys_.push_back(KeyOf({drive.keyframes.key, options, BytesOf(drive.gnss)}));
}

std::string KeptPairs::FileOf(std::size_t later) const {
  return drives_[later].log->name() + "/pairs.bin";
}

PairFindings KeptPairs::Find() const {
  PairFindings found;
  for (std::size_t b = 1; b < drives_.size(); ++b)
    for (const std::filesystem::path& source : context_.cache.sources()) {
      const std::optional<std::string> bytes = LastProduct(source / FileOf(b));
      if (!bytes) continue;
      FoundPairs pairs;
      BinaryReader{*bytes}(pairs);
      if (pairs.key != keys_[b]) continue;
      for (std::size_t a = 0; a < b; ++a) {
        const auto pair = pairs.earlier.find(keys_[a]);
        if (pair == pairs.earlier.end()) continue;
        const auto& [similarity, links] = pair->second;
        if (similarity) found.similarities.emplace(PairOfDrives{a, b}, *similarity);
        if (links) found.loops.emplace(PairOfDrives{a, b}, DecodeLinks(*links));
      }
    }
  return found;
}

void KeptPairs::Keep(const PairFindings& findings) const {
  std::map<std::size_t, FoundPairs> of_drives;
  const auto pair_of = [&](const PairOfDrives& drives) -> FoundPair& {
    return of_drives[drives.second].earlier[keys_[drives.first]];
  };
  for (const auto& [drives, similarity] : findings.similarities)
    pair_of(drives).similarity = similarity;
  for (const auto& [drives, links] : findings.loops) pair_of(drives).links = EncodeLinks(links);
  for (auto& [later, pairs] : of_drives) {
    pairs.key = keys_[later];
    BinaryWriter writer;
    writer(pairs);
    const std::string& bytes = writer.bytes();
    context_.cache.Get(FileOf(later), KeyOf({bytes}), [&bytes] { return bytes; });
  }
}

}  // namespace parkade
