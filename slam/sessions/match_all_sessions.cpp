#include "slam/sessions/match_all_sessions.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

namespace parkade {
namespace {

/// [m] how far a drive may lie from where GNSS puts it.
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
  return {a.gnss->site_from_odom.Inverse() * b.gnss->site_from_odom,
          std::hypot(SigmaOf(*a.gnss), SigmaOf(*b.gnss))};
}

/// Links pairs of drives, each at most once.
class PairLinker {
 public:
  PairLinker(const std::vector<DriveToJoin>& drives, const LoopOptions& loops,
             const SessionLoopOptions& options, const PairFindings& known)
      : drives_(drives), described_(drives), loops_(loops), options_(options), known_(known) {}

  void Link(const PairOfDrives& key) {
    if (!IsLinked(key)) found_.loops.emplace(key, LoopsOf(key));
  }

  double Similarity(const PairOfDrives& key) {
    const auto found = found_.similarities.find(key);
    return found != found_.similarities.end()
               ? found->second
               : found_.similarities.emplace(key, SimilarityOfPair(key)).first->second;
  }

  bool IsLinked(const PairOfDrives& key) const { return found_.loops.contains(key); }

  /// Sorted by drive_b, then drive_a.
  std::vector<DrivePair> Pairs() const {
    std::vector<DrivePair> pairs;
    for (const auto& [key, loops] : found_.loops) {
      const std::vector<double> zeros(loops.links.size(), 0), ones(loops.links.size(), 1);
      pairs.push_back({key.first, key.second, loops, ones, zeros});
    }
    std::sort(pairs.begin(), pairs.end(), [](const DrivePair& x, const DrivePair& y) {
      return std::pair(x.drive_b, x.drive_a) < std::pair(y.drive_b, y.drive_a);
    });
    return pairs;
  }
  const PairFindings& findings() const { return found_; }

 private:
  SessionLoops LoopsOf(const PairOfDrives& key) {
    if (const auto known = known_.loops.find(key); known != known_.loops.end())
      return known->second;
    const GnssPrior prior = PriorOf(drives_[key.first], drives_[key.second]);
    return MatchSessions(described_.KeyframesOf(key.first), described_.KeyframesOf(key.second),
                         options_, loops_.relative_pose, prior.a_from_b, prior.sigma);
  }

  double SimilarityOfPair(const PairOfDrives& key) {
    if (const auto known = known_.similarities.find(key); known != known_.similarities.end())
      return known->second;
    const GnssPrior prior = PriorOf(drives_[key.first], drives_[key.second]);
    return SimilarityOf(Compared(key.first), Compared(key.second), options_, prior.a_from_b,
                        prior.sigma);
  }

  const ComparedDrive& Compared(size_t drive) {
    const auto found = compared_.find(drive);
    if (found != compared_.end()) return found->second;
    const ComparedDrive compared(drives_[drive].keyframes, described_.WordsOf(drive));
    return compared_.emplace(drive, compared).first->second;
  }

  const std::vector<DriveToJoin>& drives_;
  DescribedDrives described_;
  const LoopOptions& loops_;
  const SessionLoopOptions& options_;
  const PairFindings& known_;
  std::map<size_t, ComparedDrive> compared_;  ///< of drives whose similarity is asked for
  PairFindings found_;
};

std::vector<PairOfDrives> AllPairs(size_t num_drives) {
  std::vector<PairOfDrives> pairs;
  for (size_t b = 1; b < num_drives; ++b)
    for (size_t a = 0; a < b; ++a) pairs.emplace_back(a, b);
  return pairs;
}

/// Each drive with those before it that look most like it: a drive that comes last makes no more
/// pairs than that, however many would choose it.
std::vector<PairOfDrives> AlikePairs(size_t num_drives, size_t partners, PairLinker& linker) {
  std::set<PairOfDrives> chosen;
  for (size_t i = 0; i < num_drives; ++i) {
    std::vector<std::pair<double, PairOfDrives>> others;  // similarity, negative
    for (size_t k = 0; k < i; ++k) {
      const PairOfDrives key(k, i);
      if (linker.Similarity(key) > 0) others.emplace_back(-linker.Similarity(key), key);
    }
    std::sort(others.begin(), others.end());
    for (size_t n = 0; n < std::min(partners, others.size()); ++n) chosen.insert(others[n].second);
  }
  return {chosen.begin(), chosen.end()};
}

/// The most alike pair of each two groups that is not linked yet.
std::vector<PairOfDrives> PairsBetweenGroups(const std::vector<size_t>& groups,
                                             PairLinker& linker) {
  std::map<PairOfDrives, std::pair<double, PairOfDrives>> best;
  for (const PairOfDrives& key : AllPairs(groups.size())) {
    const PairOfDrives between = std::minmax(groups[key.first], groups[key.second]);
    if (between.first == between.second || linker.IsLinked(key) || linker.Similarity(key) <= 0)
      continue;
    const auto [entry, is_new] = best.try_emplace(between, linker.Similarity(key), key);
    if (linker.Similarity(key) > entry->second.first) entry->second = {linker.Similarity(key), key};
  }
  std::vector<PairOfDrives> pairs;
  for (const auto& [between, candidate] : best) pairs.push_back(candidate.second);
  return pairs;
}

}  // namespace

MatchedSessions MatchAllSessions(const std::vector<DriveToJoin>& drives, const LoopOptions& loops,
                                 const SessionLoopOptions& options, const PairFindings& known) {
  PairLinker linker(drives, loops, options, known);
  const auto link = [&linker](const std::vector<PairOfDrives>& pairs) {
    for (const PairOfDrives& key : pairs) linker.Link(key);
  };
  if (drives.size() <= static_cast<size_t>(options.all_pairs_up_to)) {
    link(AllPairs(drives.size()));
  } else {
    link(AlikePairs(drives.size(), static_cast<size_t>(options.partners), linker));
    for (int i = 0; i < options.partners; ++i)
      link(PairsBetweenGroups(FindGroups(drives.size(), linker.Pairs()), linker));
  }
  return {linker.Pairs(), linker.findings()};
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
