#include "slam/sessions/register_sites.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/math/statistics.h"
#include "slam/georeference/align_points.h"

namespace parkade {
namespace {

constexpr size_t kMostPairs = 6;       // of drives, the most alike
constexpr double kMinScale = 0.03;     // [m] residuals below it are all alike
constexpr int kNumRounds = 10;         // of reweighting
constexpr double kAgreeingScales = 5;  // a link farther off does not agree

/// One keyframe of the later site's drive, where both sites have it.
struct KeyframeInBoth {
  Rigid3 from_from_keyframe, to_from_keyframe;
};

struct DrivePairIndex {
  size_t from = 0, to = 0;
  double similarity = 0;
};

std::vector<DrivePairIndex> ChoosePairs(const std::vector<std::vector<RigKeyframe>>& from,
                                        const std::vector<std::vector<RigKeyframe>>& to,
                                        const SessionLoopOptions& options,
                                        const std::optional<Rigid3>& from_from_to, double sigma) {
  std::vector<DrivePairIndex> pairs;
  for (size_t i = 0; i < from.size(); ++i)
    for (size_t j = 0; j < to.size(); ++j) pairs.push_back({i, j});
  if (pairs.size() <= kMostPairs) return pairs;
  const std::vector<ComparedDrive> drives_from(from.begin(), from.end()),
      drives_to(to.begin(), to.end());
  for (DrivePairIndex& pair : pairs)
    pair.similarity =
        SimilarityOf(drives_from[pair.from], drives_to[pair.to], options, from_from_to, sigma);
  std::stable_sort(
      pairs.begin(), pairs.end(),
      [](const DrivePairIndex& a, const DrivePairIndex& b) { return a.similarity > b.similarity; });
  pairs.resize(kMostPairs);
  return pairs;
}

std::vector<KeyframeInBoth> LinkSites(const std::vector<std::vector<RigKeyframe>>& from,
                                      const std::vector<std::vector<RigKeyframe>>& to,
                                      const SessionLoopOptions& options,
                                      const RelativePoseOptions& relative_pose,
                                      const std::optional<SitePrior>& prior) {
  std::optional<Rigid3> from_from_to;
  if (prior) from_from_to = prior->to_from_from.Inverse();
  const double sigma = prior ? prior->sigma : 0;
  std::vector<KeyframeInBoth> found;
  for (const DrivePairIndex& pair : ChoosePairs(from, to, options, from_from_to, sigma)) {
    const std::vector<RigKeyframe>&a = from[pair.from], &b = to[pair.to];
    for (const SessionLoop& link :
         MatchSessions(a, b, options, relative_pose, from_from_to, sigma).links)
      found.push_back({a[link.keyframe_a].odom_from_keyframe * link.pose.a_from_b,
                       b[link.keyframe_b].odom_from_keyframe});
  }
  return found;
}

Rigid3 Fit(const std::vector<KeyframeInBoth>& keyframes, const std::vector<double>& weights) {
  constexpr double kReach =
      3;  // [m] so that a keyframe's own heading counts as well as where the others lie
  const std::array<Eigen::Vector3d, 5> spots = {
      Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(kReach, 0, 0), Eigen::Vector3d(-kReach, 0, 0),
      Eigen::Vector3d(0, kReach, 0), Eigen::Vector3d(0, -kReach, 0)};
  const auto count = static_cast<Eigen::Index>(spots.size() * keyframes.size());
  Eigen::Matrix3Xd source(3, count), target(3, count);
  Eigen::VectorXd weight(count);
  Eigen::Index column = 0;
  for (size_t i = 0; i < keyframes.size(); ++i)
    for (const Eigen::Vector3d& spot : spots) {
      source.col(column) = keyframes[i].from_from_keyframe * spot;
      target.col(column) = keyframes[i].to_from_keyframe * spot;
      weight[column++] = weights[i];
    }
  return AlignYawAndTranslation(source, target, weight, weight);
}

Eigen::Vector3d ResidualOf(const KeyframeInBoth& keyframe, const Rigid3& to_from_from) {
  return keyframe.to_from_keyframe.translation -
         to_from_from * keyframe.from_from_keyframe.translation;
}

}  // namespace

std::optional<SiteRegistration> RegisterSites(const std::vector<std::vector<RigKeyframe>>& from,
                                              const std::vector<std::vector<RigKeyframe>>& to,
                                              const SessionLoopOptions& options,
                                              const RelativePoseOptions& relative_pose,
                                              const std::optional<SitePrior>& prior) {
  const std::vector<KeyframeInBoth> keyframes = LinkSites(from, to, options, relative_pose, prior);
  if (keyframes.empty()) return std::nullopt;
  SiteRegistration found;
  std::vector<double> weights(keyframes.size(), 1), residuals(keyframes.size());
  double scale = 0;
  for (int round = 0; round < kNumRounds; ++round) {
    found.to_from_from = Fit(keyframes, weights);
    for (size_t i = 0; i < keyframes.size(); ++i)
      residuals[i] = ResidualOf(keyframes[i], found.to_from_from).norm();
    scale = std::max(kMinScale, MadSigma(residuals, 0));
    for (size_t i = 0; i < keyframes.size(); ++i)
      weights[i] = 1 / (1 + std::pow(residuals[i] / scale, 2));
  }
  std::vector<double> horizontal, vertical;
  for (const KeyframeInBoth& keyframe : keyframes) {
    const Eigen::Vector3d residual = ResidualOf(keyframe, found.to_from_from);
    horizontal.push_back(residual.head<2>().norm());
    vertical.push_back(std::abs(residual.z()));
    const bool agrees = residual.norm() < kAgreeingScales * std::min(scale, options.closing_base);
    found.num_links += agrees;
  }
  if (found.num_links < static_cast<size_t>(options.min_links) ||
      2 * found.num_links < keyframes.size())
    return std::nullopt;
  constexpr double kMedianOfRayleigh = 1.1774;  // of two axes, in sigmas of one
  found.horizontal_sigma = Median(horizontal) / kMedianOfRayleigh;
  found.height_sigma = MadSigma(vertical, 0);
  return found;
}

}  // namespace parkade
