#include "slam/loops/measure_loops.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <span>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "slam/baselines/relative_pose_baselines.h"
#include "slam/places/estimate_rig_pose.h"

namespace parkade {
namespace {

constexpr size_t kCandidatesAtOnce = 64;  // whose keyframes are in memory
constexpr int kViewQuality = 80;          // of JPEG

// Below these no loop without scale is believed: two cameras do not hold together as four do.
constexpr double kFloorTranslation = 0.02;           // [m] across the direction, at least
constexpr double kFloorRotation = 0.1 * M_PI / 180;  // [rad]

/// Keyframes with their features, by their index.
using LoadedKeyframes = std::map<size_t, std::shared_ptr<const RigKeyframe>>;

/// The keyframes of some candidates; those that were loaded before are taken from there.
LoadedKeyframes Load(std::span<const PlaceCandidate> candidates,
                     const std::vector<RigKeyframe>& keyframes, const KeyframeStore& described,
                     const LoadedKeyframes& before) {
  LoadedKeyframes loaded;
  for (const PlaceCandidate& candidate : candidates)
    for (const size_t index : {candidate.earlier, candidate.later}) loaded.try_emplace(index);
  std::vector<std::pair<size_t, std::shared_ptr<const RigKeyframe>*>> missing;
  for (auto& [index, keyframe] : loaded)
    if (const auto known = before.find(index); known != before.end())
      keyframe = known->second;
    else
      missing.emplace_back(index, &keyframe);
  ParallelFor(missing.size(), [&](size_t i) {
    std::optional<RigKeyframe> found = described.Find(keyframes[missing[i].first].time);
    Require(found.has_value(), ErrorCode::kInternal, "a loop's keyframe was not described");
    *missing[i].second = std::make_shared<const RigKeyframe>(std::move(*found));
  });
  return loaded;
}

/// The factor of the five-point method is between two cameras; the length of the way between them
/// is unknown. The evidence shows the odometry's length.
void MeasureWithoutScale(const RigKeyframe& earlier, const RigKeyframe& later,
                         const std::vector<FeatureMatch>& matches, const Rigid3& by_odometry,
                         const LoopOptions& options, LoopEvidence& loop) {
  const TwoViewPose pose = EstimateTwoViewPose(earlier, later, matches, options.relative_pose);
  loop.pose.num_matches = pose.num_matches;
  loop.pose.num_inliers = pose.num_inliers;
  loop.pose.num_camera_pairs = 1;
  loop.pose.rejected = pose.rejected;
  if (!pose.rejected.empty()) return;
  const Eigen::Vector3d baseline = by_odometry * pose.second_in_b - pose.first_in_a;
  const Eigen::Vector3d direction = pose.first_from_second.translation;
  const Rigid3 scaled{pose.first_from_second.rotation,
                      std::max(direction.dot(baseline), 0.01) * direction};
  loop.earlier_from_camera = {Eigen::Quaterniond::Identity(), pose.first_in_a};
  loop.later_from_camera = {Eigen::Quaterniond::Identity(), pose.second_in_b};
  loop.pose.a_from_b = loop.earlier_from_camera * scaled * loop.later_from_camera.Inverse();
  const double sigma =
      std::hypot(pose.direction_sigma * scaled.translation.norm(), kFloorTranslation);
  loop.pose.worst_sigma = sigma;
  loop.pose.information = ScaleLessInformation(
      scaled,
      pose.rotation_covariance + kFloorRotation * kFloorRotation * Eigen::Matrix3d::Identity(),
      sigma, options.method == "scale-less");
}

LoopEvidence Measure(const PlaceCandidate& candidate, const RigKeyframe& earlier,
                     const RigKeyframe& later, const LoopOptions& options) {
  LoopEvidence loop;
  loop.id = std::to_string(candidate.earlier) + "-" + std::to_string(candidate.later);
  loop.earlier_keyframe = candidate.earlier;
  loop.later_keyframe = candidate.later;
  loop.earlier = earlier.time;
  loop.later = later.time;
  loop.way = later.distance - earlier.distance;
  loop.score = candidate.score;
  const Rigid3 by_odometry = earlier.odom_from_keyframe.Inverse() * later.odom_from_keyframe;
  const std::vector<FeatureMatch> matches = MatchKeyframes(earlier, later, options.relative_pose);
  if (options.method == "rig") {
    loop.pose = EstimateRigPose(earlier, later, matches, options.relative_pose);
  } else if (options.method == "pnp") {
    loop.pose = EstimatePnpPose(earlier, later, matches, options.relative_pose);
  } else {
    MeasureWithoutScale(earlier, later, matches, by_odometry, options, loop);
  }
  if (!loop.pose.inliers_of_cameras.empty()) {
    loop.earlier_camera = loop.pose.inliers_of_cameras.front().camera_a;
    loop.later_camera = loop.pose.inliers_of_cameras.front().camera_b;
  }
  loop.odometry_disagreement = (loop.pose.a_from_b.translation - by_odometry.translation).norm();
  return loop;
}

/// Adds what one end of a loop saw.
void AddView(const RigKeyframe& keyframe, size_t index, int camera, LoopViews& views) {
  const auto of_camera = static_cast<size_t>(camera);
  if (of_camera >= keyframe.views.size() || keyframe.views[of_camera].empty()) return;
  const auto [view, is_new] = views.try_emplace({index, camera});
  if (!is_new) return;
  std::vector<uchar> jpeg;
  cv::imencode(".jpg", keyframe.views[of_camera], jpeg, {cv::IMWRITE_JPEG_QUALITY, kViewQuality});
  view->second.assign(jpeg.begin(), jpeg.end());
}

}  // namespace

MeasuredLoops MeasureLoops(const KeyframeStore& described,
                           const std::vector<RigKeyframe>& keyframes,
                           const std::vector<PlaceCandidate>& candidates,
                           const LoopOptions& options) {
  MeasuredLoops measured;
  LoadedKeyframes loaded;
  for (size_t begin = 0; begin < candidates.size(); begin += kCandidatesAtOnce) {
    const std::span part =
        std::span(candidates)
            .subspan(begin, std::min(kCandidatesAtOnce, candidates.size() - begin));
    loaded = Load(part, keyframes, described, loaded);
    std::vector<LoopEvidence> loops = ParallelMap(part.size(), [&](size_t i) {
      return Measure(part[i], *loaded.at(part[i].earlier), *loaded.at(part[i].later), options);
    });
    for (LoopEvidence& loop : loops) {
      for (const auto& [keyframe, camera] : {std::pair(loop.earlier_keyframe, loop.earlier_camera),
                                             std::pair(loop.later_keyframe, loop.later_camera)})
        AddView(*loaded.at(keyframe), keyframe, camera, measured.views);
      measured.loops.push_back(std::move(loop));
    }
  }
  return measured;
}

}  // namespace parkade
