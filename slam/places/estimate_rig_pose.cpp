#include "slam/places/estimate_rig_pose.h"

#include <map>
#include <random>

#include "slam/places/adjust_to_correspondences.h"
#include "slam/places/guided_matches.h"
#include "slam/places/hamming.h"
#include "slam/places/ray_point_correspondence.h"

namespace parkade {
namespace {

constexpr int kRounds = 3;                       // rounds of choosing inliers and adjusting
constexpr double kTiltSigma = 0.3 * M_PI / 180;  // [rad] between the gravity of two keyframes

/// How many correspondences a pose explains; 0 as soon as they cannot be more than `most`.
size_t CountInliers(const std::vector<RayPointCorrespondence>& correspondences,
                    const Rigid3& a_from_b, double max_error, size_t most) {
  size_t count = 0;
  for (size_t i = 0; i < correspondences.size(); ++i) {
    if (count + correspondences.size() - i <= most) return 0;
    count += IsInlier(correspondences[i], a_from_b, max_error);
  }
  return count;
}

std::optional<Rigid3> SearchPose(const std::vector<RayPointCorrespondence>& correspondences,
                                 const RelativePoseOptions& options) {
  std::vector<size_t> forward, backward;
  for (size_t i = 0; i < correspondences.size(); ++i)
    (correspondences[i].is_forward ? forward : backward).push_back(i);
  std::mt19937 random(1);
  const auto pick = [&random](const std::vector<size_t>& from) {
    return from[random() % from.size()];
  };
  std::optional<Rigid3> best;
  size_t most = 0;
  for (int i = 0; i < options.iterations; ++i) {
    const std::vector<size_t>& from =
        (i % 2 == 0 && forward.size() > 1) || backward.size() < 2 ? forward : backward;
    if (from.size() < 2) break;
    const size_t first = pick(from), second = pick(from);
    if (first == second) continue;
    for (const Rigid3& pose : SolveUprightPose(correspondences[first], correspondences[second])) {
      const size_t count = CountInliers(correspondences, pose, options.max_error, most);
      if (count <= most) continue;
      most = count;
      best = pose;
    }
  }
  return best;
}

std::vector<CameraPairInliers> CountByCameras(const std::map<size_t, int>& camera_pair_of_match) {
  std::map<int, int> counts;
  for (const auto& [match, pair] : camera_pair_of_match) ++counts[pair];
  std::vector<CameraPairInliers> by_cameras;
  by_cameras.reserve(counts.size());
  for (const auto& [pair, count] : counts)
    by_cameras.push_back({pair / kCamerasPerKeyframe, pair % kCamerasPerKeyframe, count});
  std::stable_sort(
      by_cameras.begin(), by_cameras.end(),
      [](const CameraPairInliers& a, const CameraPairInliers& b) { return a.count > b.count; });
  return by_cameras;
}

/// Every so many-th inlier, so that there are no more than people can look through.
ShownInliers ShowInliers(const RigKeyframe& a, const RigKeyframe& b,
                         const std::vector<FeatureMatch>& inliers, const CameraPairInliers& most) {
  constexpr size_t kMostShown = 24;
  const auto time_of = [](const RigKeyframe& keyframe, int camera) {
    const auto index = static_cast<size_t>(camera);
    return index < keyframe.image_times.size() ? keyframe.image_times[index] : keyframe.time;
  };
  ShownInliers shown{
      most.camera_a, most.camera_b, time_of(a, most.camera_a), time_of(b, most.camera_b), {}};
  std::vector<MatchedPoint> all;
  for (const FeatureMatch& match : inliers) {
    const KeyframeFeature &of_a = a.features[match.a], &of_b = b.features[match.b];
    if (of_a.camera == most.camera_a && of_b.camera == most.camera_b && of_a.image_point.x() >= 0 &&
        of_b.image_point.x() >= 0)
      all.push_back({of_a.image_point, of_b.image_point});
  }
  const size_t step = 1 + all.size() / (kMostShown + 1);
  for (size_t i = 0; i < all.size(); i += step) shown.points.push_back(all[i]);
  return shown;
}

/// A pose adjusted to its inliers.
struct Adjusted {
  std::vector<RayPointCorrespondence> inliers;
  std::vector<size_t> inlier_matches;  ///< indices
  Matrix6d hessian = Matrix6d::Identity();
};

/// Chooses inliers and adjusts the pose to them, by turns.
Adjusted AdjustToInliers(const std::vector<RayPointCorrespondence>& correspondences,
                         const RelativePoseOptions& options, RelativePose& pose) {
  Adjusted adjusted;
  for (int round = 0; round < kRounds; ++round) {
    adjusted.inliers.clear();
    std::map<size_t, int> camera_pair_of_match;
    double sum = 0;
    for (const RayPointCorrespondence& correspondence : correspondences) {
      if (!IsInlier(correspondence, pose.a_from_b, options.max_error)) continue;
      adjusted.inliers.push_back(correspondence);
      camera_pair_of_match[correspondence.match] = correspondence.camera_pair;
      sum += ErrorOf(correspondence, pose.a_from_b).whitened.squaredNorm();
    }
    adjusted.inlier_matches.clear();
    for (const auto& [match, pair] : camera_pair_of_match) adjusted.inlier_matches.push_back(match);
    pose.num_inliers = static_cast<int>(camera_pair_of_match.size());
    pose.inliers_of_cameras = CountByCameras(camera_pair_of_match);
    pose.num_camera_pairs = static_cast<int>(pose.inliers_of_cameras.size());
    const double num_numbers = 2.0 * static_cast<double>(adjusted.inliers.size());
    pose.residual = adjusted.inliers.empty() ? 0 : std::sqrt(sum / num_numbers);
    adjusted.hessian = AdjustToCorrespondences(adjusted.inliers, kTiltSigma, pose.a_from_b);
  }
  return adjusted;
}

std::string ReasonAgainst(const RelativePose& pose, const RelativePoseOptions& options) {
  const int needed = pose.num_camera_pairs > 1 ? options.min_inliers : options.min_inliers_of_one;
  if (pose.num_inliers < needed) return "too few inliers";
  const double tilt =
      std::acos(std::clamp((pose.a_from_b.rotation * Eigen::Vector3d::UnitZ()).z(), -1.0, 1.0));
  if (tilt > options.max_tilt_deg * M_PI / 180) return "gravity differs";
  if (!(pose.worst_sigma < options.max_sigma)) return "a direction is not fixed";
  return "";
}

}  // namespace

std::vector<FeatureMatch> MatchKeyframes(const RigKeyframe& a, const RigKeyframe& b,
                                         const RelativePoseOptions& options) {
  if (a.descriptors.rows < 2 || b.descriptors.rows < 2) return {};
  struct Best {
    size_t of_a = 0;
    int distance = 0;
  };
  std::vector<std::optional<Best>> best_of_b(b.features.size());
  const DescriptorSet of_b(b.descriptors);
  for (int row = 0; row < a.descriptors.rows; ++row) {
    const NearestDescriptor nearest = of_b.FindNearest(a.descriptors.ptr(row));
    if (nearest.index < 0 || nearest.distance > options.max_hamming ||
        nearest.distance > options.ratio * nearest.second_distance)
      continue;
    std::optional<Best>& best = best_of_b[static_cast<size_t>(nearest.index)];
    if (!best || nearest.distance < best->distance)
      best = {static_cast<size_t>(row), nearest.distance};
  }
  std::vector<FeatureMatch> matches;
  for (size_t i = 0; i < best_of_b.size(); ++i)
    if (best_of_b[i]) matches.push_back({best_of_b[i]->of_a, i});
  return matches;
}

RelativePose EstimateRigPose(const RigKeyframe& a, const RigKeyframe& b,
                             const std::vector<FeatureMatch>& matches,
                             const RelativePoseOptions& options) {
  RelativePose pose;
  pose.num_matches = static_cast<int>(matches.size());
  const std::vector<RayPointCorrespondence> correspondences = CorrespondencesOf(a, b, matches);
  const std::optional<Rigid3> found = SearchPose(correspondences, options);
  if (!found) {
    pose.rejected = "too few inliers";
    return pose;
  }
  pose.a_from_b = *found;
  Adjusted adjusted = AdjustToInliers(correspondences, options, pose);
  pose.num_first_inliers = pose.num_inliers;
  std::vector<FeatureMatch> adjusted_to = matches;
  if (pose.num_inliers >= options.min_guiding_inliers) {
    adjusted_to = FindGuidedMatches(a, b, pose.a_from_b, options);
    adjusted = AdjustToInliers(CorrespondencesOf(a, b, adjusted_to), options, pose);
  }
  if (!pose.inliers_of_cameras.empty()) {
    std::vector<FeatureMatch> inliers;
    for (const size_t match : adjusted.inlier_matches) inliers.push_back(adjusted_to[match]);
    pose.shown = ShowInliers(a, b, inliers, pose.inliers_of_cameras.front());
  }
  SetInformation(
      CovarianceOfCorrespondences(adjusted.inliers, adjusted.hessian, pose.a_from_b, options),
      pose);
  pose.rejected = ReasonAgainst(pose, options);
  return pose;
}

}  // namespace parkade
