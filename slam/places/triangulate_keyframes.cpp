#include "slam/factors/triangulate.h"
#include "slam/places/describe_keyframes.h"
#include "slam/places/hamming.h"

namespace parkade {
namespace {

constexpr int kMaxHamming = 60;       // of 256 bits
constexpr double kRatio = 0.85;       // of the best to the second best distance
constexpr double kMaxOffPlane = 4;    // [sigma] off the epipolar plane
constexpr double kMaxError = 3.5;     // [sigma] of a ray from its point
constexpr double kMinDistance = 0.5;  // [m]
constexpr double kExtraSigma = 5e-4;  // [rad] of the odometry between keyframes

/// The one feature of `other` that looks like feature `index` of `keyframe` and lies on its
/// epipolar line; none where two are alike.
std::optional<size_t> FindAlong(const RigKeyframe& keyframe, size_t index, const RigKeyframe& other,
                                const Rigid3& keyframe_from_other) {
  const KeyframeFeature& feature = keyframe.features[index];
  const uchar* wanted = keyframe.descriptors.ptr(static_cast<int>(index));
  NearestDescriptor nearest;
  for (size_t i = 0; i < other.features.size(); ++i) {
    const KeyframeFeature& candidate = other.features[i];
    if (candidate.camera != feature.camera) continue;
    const Eigen::Vector3d baseline = keyframe_from_other * candidate.origin - feature.origin;
    const Eigen::Vector3d normal = baseline.cross(feature.bearing);
    const double size = normal.norm();
    if (size < 0.02) continue;  // [m] there is no parallax along the way of the car
    const Eigen::Vector3d bearing = keyframe_from_other.rotation * candidate.bearing;
    const double sigma = feature.sigma + candidate.sigma + kExtraSigma;
    const int row = static_cast<int>(i);
    if (std::abs(normal.dot(bearing)) <= kMaxOffPlane * sigma * size)
      nearest.Add(row, HammingDistance(wanted, other.descriptors.ptr(row)));
  }
  return nearest.Found(kMaxHamming, kRatio);
}

void TriangulateFeature(std::span<const RigKeyframe> keyframes, size_t index, size_t i,
                        const KeyframeOptions& options, KeyframeFeature& feature) {
  const RigKeyframe& keyframe = keyframes[index];
  std::vector<ObservationRay> rays = {
      {feature.origin, feature.bearing, feature.sigma + kExtraSigma}};
  const size_t first = index - std::min(index, kNeighborKeyframes),
               last = std::min(index + kNeighborKeyframes, keyframes.size() - 1);
  for (size_t other = first; other <= last; ++other) {
    if (other == index) continue;
    const Rigid3 keyframe_from_other =
        keyframe.odom_from_keyframe.Inverse() * keyframes[other].odom_from_keyframe;
    const std::optional<size_t> match =
        FindAlong(keyframe, i, keyframes[other], keyframe_from_other);
    if (!match) continue;
    const KeyframeFeature& seen = keyframes[other].features[*match];
    rays.push_back({keyframe_from_other * seen.origin, keyframe_from_other.rotation * seen.bearing,
                    seen.sigma + kExtraSigma});
  }
  const std::optional<Triangulated> result = Triangulate(rays, kMaxError, kMinDistance);
  if (!result || result->inverse_distance <= 0) return;
  const double distance = 1 / result->inverse_distance;
  const double sigma = distance * std::sqrt(2.0) * rays.front().sigma / result->parallax;
  if (distance > options.max_distance || sigma > options.max_depth_error * distance) return;
  feature.point = feature.origin + distance * feature.bearing;
  feature.depth_sigma = sigma;
}

}  // namespace

std::vector<KeyframeFeature> TriangulateFeatures(const std::vector<RigKeyframe>& keyframes,
                                                 size_t index, const KeyframeOptions& options) {
  std::vector<KeyframeFeature> features = keyframes[index].features;
  for (size_t i = 0; i < features.size(); ++i)
    TriangulateFeature(keyframes, index, i, options, features[i]);
  return features;
}

}  // namespace parkade
