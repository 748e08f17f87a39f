#include "slam/sessions/session_loops.h"

#include <algorithm>
#include <set>

#include "core/parallel.h"
#include "slam/loops/loop_shares.h"
#include "slam/places/estimate_rig_pose.h"
#include "slam/places/guided_matches.h"
#include "slam/places/widen_keyframe.h"
#include "slam/sessions/consistent_loops.h"

namespace parkade {
namespace {

constexpr size_t kMaxFloors = 24;  // pairs of keyframes whose floors are compared

/// The frame of drive b in that of drive a, by the link.
Rigid3 FrameOf(const SessionLoop& link, const std::vector<RigKeyframe>& keyframes_a,
               const std::vector<RigKeyframe>& keyframes_b) {
  return keyframes_a[link.keyframe_a].odom_from_keyframe * link.pose.a_from_b *
         keyframes_b[link.keyframe_b].odom_from_keyframe.Inverse();
}

/// [m] along the longer side of what the links' keyframes cover in drive b.
double SpreadOf(const std::vector<SessionLoop>& links,
                const std::vector<RigKeyframe>& keyframes_b) {
  double spread = 0;
  for (const SessionLoop& link : links)
    spread = std::max(spread, (keyframes_b[link.keyframe_b].odom_from_keyframe.translation -
                               keyframes_b[links.front().keyframe_b].odom_from_keyframe.translation)
                                  .norm());
  return spread;
}

std::vector<SessionLoop> Choose(const std::vector<SessionLoop>& links,
                                const std::vector<size_t>& indices) {
  std::vector<SessionLoop> chosen;
  for (const size_t index : indices) chosen.push_back(links[index]);
  return chosen;
}

std::vector<SessionLoop> WithoutThoseAt(const std::vector<SessionLoop>& links,
                                        const std::vector<size_t>& indices) {
  std::vector<SessionLoop> rest;
  for (size_t i = 0; i < links.size(); ++i)
    if (!std::binary_search(indices.begin(), indices.end(), i)) rest.push_back(links[i]);
  return rest;
}

/// Alike keyframes, the most alike first; with `a_from_b` only those within `reach` [m] of each
/// other.
std::vector<PlaceCandidate> FindCandidates(const ComparedDrive& drive_a,
                                           const ComparedDrive& drive_b,
                                           const std::optional<Rigid3>& a_from_b, double reach,
                                           int max_candidates) {
  const auto is_possible = [&](size_t a, size_t b) {
    if (!a_from_b) return true;
    const Eigen::Vector3d apart =
        (*drive_a.keyframes)[a].odom_from_keyframe.translation -
        *a_from_b * (*drive_b.keyframes)[b].odom_from_keyframe.translation;
    return apart.head<2>().norm() < reach;
  };
  std::vector<PlaceCandidate> candidates =
      FindAlikePlaces(drive_a.words, drive_b.words, is_possible, max_candidates);
  std::stable_sort(
      candidates.begin(), candidates.end(),
      [](const PlaceCandidate& a, const PlaceCandidate& b) { return a.score > b.score; });
  return candidates;
}

/// A drive's floors, and how much they show.
struct JudgedFloors {
  explicit JudgedFloors(const std::vector<RigKeyframe>& keyframes)
      : floors(keyframes), within(CompareNeighbors(floors, keyframes)) {}

  DriveFloors floors;
  BevAgreement within;
};

/// The work of MatchSessions on one pair of drives.
class DriveLinker {
 public:
  DriveLinker(const std::vector<RigKeyframe>& keyframes_a,
              const std::vector<RigKeyframe>& keyframes_b, const SessionLoopOptions& options,
              const RelativePoseOptions& relative_pose)
      : keyframes_a_(keyframes_a),
        keyframes_b_(keyframes_b),
        options_(options),
        relative_pose_(relative_pose) {}

  SessionLoops Link(const std::optional<Rigid3>& a_from_b, double sigma) {
    const std::vector<PlaceCandidate> candidates =
        FindCandidates(ComparedDrive(keyframes_a_), ComparedDrive(keyframes_b_), a_from_b,
                       options_.reach + 3 * sigma, options_.max_candidates);
    result_.num_candidates = static_cast<int>(candidates.size());
    const size_t most = std::min(candidates.size(), static_cast<size_t>(options_.max_measured));
    for (size_t begin = 0; begin < most && result_.links.empty();
         begin += static_cast<size_t>(options_.batch)) {
      const size_t end = std::min(begin + static_cast<size_t>(options_.batch), most);
      Measure({candidates.begin() + static_cast<std::ptrdiff_t>(begin),
               candidates.begin() + static_cast<std::ptrdiff_t>(end)},
              {});
      Judge();
    }
    if (!result_.links.empty()) MeasureForetold();
    return std::move(result_);
  }

 private:
  /// Measures candidates and adds the good ones to measured_. `foretold`: keyframe b of each in
  /// keyframe a; empty: nothing is known of that.
  void Measure(const std::vector<PlaceCandidate>& candidates, const std::vector<Rigid3>& foretold) {
    std::vector<SessionLoop> links = ParallelMap(candidates.size(), [&](size_t i) {
      return MeasureLink(keyframes_a_, keyframes_b_, candidates[i], options_, relative_pose_,
                         foretold.empty() ? std::nullopt : std::optional(foretold[i]));
    });
    for (SessionLoop& link : links) {
      tried_.insert({link.keyframe_a, link.keyframe_b});
      if (link.pose.rejected.empty()) measured_.push_back(std::move(link));
    }
    result_.num_measured = static_cast<int>(tried_.size());
  }

  /// Takes the links that agree where they are enough and without rival.
  void Judge() {
    const std::vector<size_t> best =
        FindConsistentLoops(keyframes_a_, keyframes_b_, measured_, options_);
    const std::vector<SessionLoop> agreeing = Choose(measured_, best),
                                   others = WithoutThoseAt(measured_, best);
    result_.num_agreeing = static_cast<int>(best.size());
    result_.num_rivals =
        static_cast<int>(FindConsistentLoops(keyframes_a_, keyframes_b_, others, options_).size());
    result_.rejected = "";
    if (measured_.empty()) {
      result_.rejected = "no places in common";
    } else if (result_.num_agreeing < options_.min_links) {
      result_.rejected = "too few links agree";
    } else if (SpreadOf(agreeing, keyframes_b_) < options_.min_spread) {
      result_.rejected = "all links are at one spot";
    } else if (result_.num_rivals > options_.max_rival_share * result_.num_agreeing) {
      result_.rejected = "ambiguous: other links agree on another pose";
    } else if (IsOnAnotherFloor(agreeing)) {
      result_.rejected = "the floor is another one";
    } else {
      result_.links = agreeing;
    }
  }

  /// Whether the floors show enough to tell that they are not the same. Reflections move with the
  /// car and spoil a drive's fit with itself, not with another day: one drive that shows its floor
  /// is enough.
  bool IsOnAnotherFloor(const std::vector<SessionLoop>& links) {
    if (!floors_) floors_ = {JudgedFloors(keyframes_a_), JudgedFloors(keyframes_b_)};
    const JudgedFloors &a = floors_->first, &b = floors_->second;
    BevEvidence& floor = result_.floor = {};
    floor.within += a.within;
    floor.within += b.within;
    floor.across = SumOverSome(links.size(), kMaxFloors, [&](size_t i) {
      return CompareBevs(a.floors, links[i].keyframe_a, b.floors, links[i].keyframe_b,
                         links[i].pose.a_from_b);
    });
    for (const BevAgreement& agreement : {a.within, b.within, floor.across})
      if (agreement.num_tiles < options_.min_floor_tiles) return false;
    return std::max(a.within.share(), b.within.share()) > options_.telling_floor &&
           floor.across.share() < options_.min_floor_share * floor.within.share();
  }

  /// Where the links say that the drives pass each other, the nearest keyframes are measured as
  /// well.
  void MeasureForetold() {
    constexpr size_t kNearest = 1;
    std::vector<PlaceCandidate> places;
    std::vector<Rigid3> foretold;
    for (size_t b = 0; b < keyframes_b_.size(); b += static_cast<size_t>(options_.neighbors) + 1) {
      const Rigid3 a_from_b = FrameOf(NearestLink(b), keyframes_a_, keyframes_b_);
      const Eigen::Vector3d position = a_from_b * keyframes_b_[b].odom_from_keyframe.translation;
      std::vector<std::pair<double, size_t>> near;
      for (size_t a = 0; a < keyframes_a_.size(); ++a) {
        const Eigen::Vector3d apart = keyframes_a_[a].odom_from_keyframe.translation - position;
        if (apart.head<2>().norm() < options_.reach && std::abs(apart.z()) < options_.height_reach)
          near.emplace_back(apart.norm(), a);
      }
      std::sort(near.begin(), near.end());
      for (size_t i = 0; i < std::min(near.size(), kNearest); ++i)
        if (!tried_.contains({near[i].second, b})) {
          places.push_back({near[i].second, b, 0});
          foretold.push_back(keyframes_a_[near[i].second].odom_from_keyframe.Inverse() * a_from_b *
                             keyframes_b_[b].odom_from_keyframe);
        }
    }
    Measure(places, foretold);
    // What was measured from one end must still agree: the same set grows.
    result_.links =
        Choose(measured_, FindConsistentLoops(keyframes_a_, keyframes_b_, measured_, options_));
    result_.num_agreeing = static_cast<int>(result_.links.size());
  }

  const SessionLoop& NearestLink(size_t keyframe_b) const {
    return *std::min_element(
        result_.links.begin(), result_.links.end(),
        [&](const SessionLoop& x, const SessionLoop& y) {
          const double to_x =
              std::abs(keyframes_b_[x.keyframe_b].distance - keyframes_b_[keyframe_b].distance);
          const double to_y =
              std::abs(keyframes_b_[y.keyframe_b].distance - keyframes_b_[keyframe_b].distance);
          return to_x < to_y;
        });
  }

  const std::vector<RigKeyframe>&keyframes_a_, &keyframes_b_;
  const SessionLoopOptions& options_;
  const RelativePoseOptions& relative_pose_;
  std::vector<SessionLoop> measured_;          ///< good ones only
  std::set<std::pair<size_t, size_t>> tried_;  ///< keyframes that were measured, good or not
  std::optional<std::pair<JudgedFloors, JudgedFloors>> floors_;  ///< once they are asked for
  SessionLoops result_;
};

}  // namespace

SessionLoop MeasureLink(const std::vector<RigKeyframe>& keyframes_a,
                        const std::vector<RigKeyframe>& keyframes_b, const PlaceCandidate& places,
                        const SessionLoopOptions& options, const RelativePoseOptions& relative_pose,
                        const std::optional<Rigid3>& foretold) {
  const auto neighbors = static_cast<size_t>(options.neighbors);
  const RigKeyframe a = WidenKeyframe(keyframes_a, places.earlier, neighbors);
  const RigKeyframe b = WidenKeyframe(keyframes_b, places.later, neighbors);
  const std::vector<FeatureMatch> matches = foretold
                                                ? FindGuidedMatches(a, b, *foretold, relative_pose)
                                                : MatchKeyframes(a, b, relative_pose);
  SessionLoop link{places.earlier, places.later, places.score,
                   EstimateRigPose(a, b, matches, relative_pose)};
  // Points that several neighbors saw count more than once.
  const double repeats = 2 * options.neighbors + 1;
  link.pose.information /= repeats;
  link.pose.worst_sigma *= std::sqrt(repeats);
  return link;
}

double SimilarityOf(const ComparedDrive& a, const ComparedDrive& b,
                    const SessionLoopOptions& options, const std::optional<Rigid3>& a_from_b,
                    double sigma) {
  const std::vector<PlaceCandidate> candidates =
      FindCandidates(a, b, a_from_b, options.reach + 3 * sigma, 1);
  const size_t count =
      2 * static_cast<size_t>(options.min_links);  // as many as a good link needs, and some
  double sum = 0;
  for (size_t i = 0; i < std::min(count, candidates.size()); ++i) sum += candidates[i].score;
  return sum / static_cast<double>(count);
}

SessionLoops MatchSessions(const std::vector<RigKeyframe>& keyframes_a,
                           const std::vector<RigKeyframe>& keyframes_b,
                           const SessionLoopOptions& options,
                           const RelativePoseOptions& relative_pose,
                           const std::optional<Rigid3>& a_from_b, double sigma) {
  options.Validate();
  relative_pose.Validate();
  return DriveLinker(keyframes_a, keyframes_b, options, relative_pose).Link(a_from_b, sigma);
}

std::vector<double> SharesOf(const std::vector<SessionLoop>& links,
                             const std::vector<RigKeyframe>& keyframes_a,
                             const std::vector<RigKeyframe>& keyframes_b, double reach) {
  std::vector<Eigen::Vector2d> ways;
  for (const SessionLoop& link : links)
    ways.emplace_back(keyframes_a[link.keyframe_a].distance, keyframes_b[link.keyframe_b].distance);
  return SharesOf(ways, reach);
}

}  // namespace parkade
