#include "slam/sessions/link_all_drives.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "core/binary_archive.h"
#include "slam/sessions/stage_results.h"

namespace parkade {
namespace {

using PairOfDrives = std::pair<size_t, size_t>;  // the lower index first

/// [m] by which a drive may lie off, where GNSS puts it.
double SigmaOf(const GnssAlignment& gnss) {
  const double turned = gnss.covariance(0, 0) * gnss.extent * gnss.extent;
  return std::sqrt(gnss.covariance(1, 1) + gnss.covariance(2, 2) + turned);
}

/// What GNSS says about two drives.
struct GnssPrior {
  std::optional<Rigid3> a_from_b;
  double sigma = 0;  ///< [m]
};

GnssPrior PriorOf(const DriveToJoin& a, const DriveToJoin& b) {
  if (!a.gnss || !b.gnss) return {};
  return {a.gnss->site_from_odom.Inverse() * b.gnss->site_from_odom, std::hypot(SigmaOf(*a.gnss), SigmaOf(*b.gnss))};
}

/// Links pairs of drives, each at most once.
class PairLinker {
 public:
  PairLinker(const std::vector<DriveToJoin>& drives, const LoopOptions& loops, const DriveLinkOptions& options,
             const PairMemory& memory)
      : drives_(drives), loops_(loops), options_(options), memory_(memory) {}

  void Link(const PairOfDrives& key) {
    if (pairs_.contains(key)) return;
    const auto [a, b] = key;
    const std::string bytes = Recall("links", key, [&] {
      const GnssPrior prior = PriorOf(drives_[a], drives_[b]);
      return EncodeLinks(LinkDrives(drives_[a].places, drives_[b].places, options_, loops_.relative_pose,
                                    prior.a_from_b, prior.sigma));
    });
    DrivePair pair{a, b, DecodeLinks(bytes), {}, {}};
    pair.weights.assign(pair.found.links.size(), 1);
    pair.chi_squared.assign(pair.found.links.size(), 0);
    pairs_.emplace(key, std::move(pair));
  }

  double Likeness(const PairOfDrives& key) {
    const auto known = likeness_.find(key);
    if (known != likeness_.end()) return known->second;
    const auto [a, b] = key;
    const std::string bytes = Recall("likeness", key, [&] {
      const GnssPrior prior = PriorOf(drives_[a], drives_[b]);
      double likeness = LikenessOf(Compared(a), Compared(b), options_, prior.a_from_b, prior.sigma);
      BinaryWriter writer;
      writer(likeness);
      return writer.bytes();
    });
    double likeness = 0;
    BinaryReader{bytes}(likeness);
    likeness_.emplace(key, likeness);
    return likeness;
  }

  bool IsLinked(const PairOfDrives& key) const { return pairs_.contains(key); }

  /// Sorted by drive_b, then drive_a.
  std::vector<DrivePair> Pairs() const {
    std::vector<DrivePair> pairs;
    for (const auto& [key, pair] : pairs_) pairs.push_back(pair);
    std::sort(pairs.begin(), pairs.end(), [](const DrivePair& x, const DrivePair& y) {
      return std::pair(x.drive_b, x.drive_a) < std::pair(y.drive_b, y.drive_a);
    });
    return pairs;
  }

 private:
  const ComparedDrive& Compared(size_t drive) {
    return compared_.try_emplace(drive, drives_[drive].places).first->second;
  }

  std::string Recall(const std::string& what, const PairOfDrives& key, const std::function<std::string()>& compute) {
    return memory_ ? memory_(what, key.first, key.second, compute) : compute();
  }

  const std::vector<DriveToJoin>& drives_;
  const LoopOptions& loops_;
  const DriveLinkOptions& options_;
  const PairMemory& memory_;
  std::map<size_t, ComparedDrive> compared_;  ///< of drives whose likeness is asked for
  std::map<PairOfDrives, DrivePair> pairs_;
  std::map<PairOfDrives, double> likeness_;
};

std::vector<PairOfDrives> AllPairs(size_t num_drives) {
  std::vector<PairOfDrives> pairs;
  for (size_t b = 1; b < num_drives; ++b)
    for (size_t a = 0; a < b; ++a) pairs.emplace_back(a, b);
  return pairs;
}

/// Each drive with those before it that look most like it: a drive that comes last makes no more pairs than that,
/// however many would choose it.
std::vector<PairOfDrives> AlikePairs(size_t num_drives, size_t partners, PairLinker& linker) {
  std::set<PairOfDrives> chosen;
  for (size_t i = 0; i < num_drives; ++i) {
    std::vector<std::pair<double, PairOfDrives>> others;  // likeness, negative
    for (size_t k = 0; k < i; ++k) {
      const PairOfDrives key(k, i);
      if (linker.Likeness(key) > 0) others.emplace_back(-linker.Likeness(key), key);
    }
    std::sort(others.begin(), others.end());
    for (size_t n = 0; n < std::min(partners, others.size()); ++n) chosen.insert(others[n].second);
  }
  return {chosen.begin(), chosen.end()};
}

/// Of every two groups the most alike pair that is not linked yet.
std::vector<PairOfDrives> PairsBetweenGroups(const std::vector<size_t>& groups, PairLinker& linker) {
  std::map<PairOfDrives, std::pair<double, PairOfDrives>> best;
  for (const PairOfDrives& key : AllPairs(groups.size())) {
    const PairOfDrives between = std::minmax(groups[key.first], groups[key.second]);
    if (between.first == between.second || linker.IsLinked(key) || linker.Likeness(key) <= 0) continue;
    const auto [entry, is_new] = best.try_emplace(between, linker.Likeness(key), key);
    if (linker.Likeness(key) > entry->second.first) entry->second = {linker.Likeness(key), key};
  }
  std::vector<PairOfDrives> pairs;
  for (const auto& [between, candidate] : best) pairs.push_back(candidate.second);
  return pairs;
}

}  // namespace

std::vector<DrivePair> LinkAllDrives(const std::vector<DriveToJoin>& drives, const LoopOptions& loops,
                                     const DriveLinkOptions& options, const PairMemory& memory) {
  PairLinker linker(drives, loops, options, memory);
  if (drives.size() <= static_cast<size_t>(options.all_pairs_up_to)) {
    for (const PairOfDrives& key : AllPairs(drives.size())) linker.Link(key);
    return linker.Pairs();
  }
  for (const PairOfDrives& key : AlikePairs(drives.size(), static_cast<size_t>(options.partners), linker))
    linker.Link(key);
  for (int i = 0; i < options.partners; ++i)
    for (const PairOfDrives& key : PairsBetweenGroups(FindGroups(drives.size(), linker.Pairs()), linker))
      linker.Link(key);
  return linker.Pairs();
}

std::vector<size_t> FindGroups(size_t num_drives, const std::vector<DrivePair>& pairs) {
  std::vector<size_t> groups(num_drives);
  std::iota(groups.begin(), groups.end(), size_t{0});
  for (const DrivePair& pair : pairs) {
    if (pair.num_accepted() == 0) continue;
    const auto [to, from] = std::minmax({groups[pair.drive_a], groups[pair.drive_b]});
    std::replace(groups.begin(), groups.end(), size_t{from}, size_t{to});
  }
  return groups;
}

}  // namespace parkade
