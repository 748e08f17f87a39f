#include "slam/places/triangulate_keyframes.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "slam/factors/triangulate.h"
#include "slam/places/hamming.h"

namespace parkade {
namespace {

constexpr int kMaxHamming = 60;       // of 256 bits
constexpr double kRatio = 0.85;       // of the best to the second best distance
constexpr double kMaxOffPlane = 4;    // [sigma] off the epipolar plane
constexpr double kMaxError = 3.5;     // [sigma] of a ray from its point
constexpr double kMinDistance = 0.5;  // [m]
constexpr double kMinBaseline =
    0.02;  // [m] across the bearing: along the way of the car is no parallax
constexpr double kExtraSigma = 5e-4;  // [rad] of the odometry between keyframes

/// Features of another keyframe that one of its images shows, in the frame of the keyframe that is
/// worked on. Coordinates lie apart, so that many bearings are asked at a time.
struct NeighborImage {
  int camera = 0;
  Eigen::Vector3d origin_in_other;  ///< [m]
  Eigen::Vector3d origin;           ///< [m]
  size_t first = 0;                 ///< of its features among all of the other keyframe
  std::vector<double> x, y, z;      ///< of the bearings
  std::vector<double> sigma;        ///< [rad]
};

/// Another keyframe, seen from the one that is worked on.
struct Neighbor {
  const RigKeyframe* keyframe = nullptr;
  Rigid3 keyframe_from_other;
  std::vector<NeighborImage> images;
};

Neighbor MakeNeighbor(const RigKeyframe& keyframe, const RigKeyframe& other) {
  Neighbor neighbor{&other, keyframe.odom_from_keyframe.Inverse() * other.odom_from_keyframe, {}};
  for (size_t i = 0; i < other.features.size(); ++i) {
    const KeyframeFeature& feature = other.features[i];
    if (neighbor.images.empty() || neighbor.images.back().camera != feature.camera ||
        neighbor.images.back().origin_in_other != feature.origin) {
      NeighborImage image;
      image.camera = feature.camera;
      image.origin_in_other = feature.origin;
      image.origin = neighbor.keyframe_from_other * feature.origin;
      image.first = i;
      neighbor.images.push_back(std::move(image));
    }
    NeighborImage& image = neighbor.images.back();
    const Eigen::Vector3d bearing = neighbor.keyframe_from_other.rotation * feature.bearing;
    image.x.push_back(bearing.x());
    image.y.push_back(bearing.y());
    image.z.push_back(bearing.z());
    image.sigma.push_back(feature.sigma);
  }
  return neighbor;
}

/// How far the bearings are off the plane through `origin` and both cameras' places, less how far
/// they may be: not above zero where they lie on it.
void MeasureOffPlane(const NeighborImage& image, const Eigen::Vector3d& normal, double sigma,
                     std::vector<double>& off_plane) {
  const double size = normal.norm(), nx = normal.x(), ny = normal.y(), nz = normal.z();
  off_plane.resize(image.x.size());
  for (size_t i = 0; i < image.x.size(); ++i)
    off_plane[i] = std::abs(nx * image.x[i] + ny * image.y[i] + nz * image.z[i]) -
                   kMaxOffPlane * (sigma + image.sigma[i] + kExtraSigma) * size;
}

/// The one feature of the neighbor that looks like `wanted` and lies on the epipolar line of
/// `feature`; none where two are alike.
std::optional<size_t> FindAlong(const KeyframeFeature& feature, const uchar* wanted,
                                const Neighbor& neighbor, std::vector<double>& off_plane) {
  NearestDescriptor nearest;
  for (const NeighborImage& image : neighbor.images) {
    if (image.camera != feature.camera) continue;
    const Eigen::Vector3d normal = (image.origin - feature.origin).cross(feature.bearing);
    if (normal.norm() < kMinBaseline) continue;
    MeasureOffPlane(image, normal, feature.sigma, off_plane);
    for (size_t i = 0; i < off_plane.size(); ++i) {
      if (!(off_plane[i] <= 0)) continue;
      const int row = static_cast<int>(image.first + i);
      nearest.Add(row, HammingDistance(wanted, neighbor.keyframe->descriptors.ptr(row)));
    }
  }
  return nearest.Found(kMaxHamming, kRatio);
}

void TriangulateFeature(const uchar* descriptor, std::span<const Neighbor> neighbors,
                        const KeyframeOptions& options, KeyframeFeature& feature) {
  std::vector<ObservationRay> rays = {
      {feature.origin, feature.bearing, feature.sigma + kExtraSigma}};
  std::vector<double> off_plane;
  for (const Neighbor& neighbor : neighbors) {
    const std::optional<size_t> match = FindAlong(feature, descriptor, neighbor, off_plane);
    if (!match) continue;
    const KeyframeFeature& seen = neighbor.keyframe->features[*match];
    rays.push_back({neighbor.keyframe_from_other * seen.origin,
                    neighbor.keyframe_from_other.rotation * seen.bearing,
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
  const RigKeyframe& keyframe = keyframes[index];
  std::vector<Neighbor> neighbors;
  const size_t first = index - std::min(index, kNeighborKeyframes),
               last = std::min(index + kNeighborKeyframes, keyframes.size() - 1);
  for (size_t other = first; other <= last; ++other)
    if (other != index) neighbors.push_back(MakeNeighbor(keyframe, keyframes[other]));
  std::vector<KeyframeFeature> features = keyframe.features;
  for (size_t i = 0; i < features.size(); ++i)
    TriangulateFeature(keyframe.descriptors.ptr(static_cast<int>(i)), neighbors, options,
                       features[i]);
  return features;
}

}  // namespace parkade
