#include "slam/factors/triangulate.h"
#include "slam/places/describe_places.h"
#include "slam/places/likest_feature.h"

namespace parkade {
namespace {

constexpr int kMaxHamming = 60;       // of 256 bits
constexpr double kRatio = 0.85;       // of the best to the second best distance
constexpr double kMaxOffPlane = 4;    // [sigma] off the epipolar plane
constexpr double kMaxError = 3.5;     // [sigma] of a ray from its point
constexpr double kMinDistance = 0.5;  // [m]
constexpr double kExtraSigma = 5e-4;  // [rad] of the odometry between places

/// The one feature of `other` that looks like feature `index` of `place` and lies on its epipolar line; none where
/// two are alike.
std::optional<size_t> FindAlong(const Place& place, size_t index, const Place& other, const Rigid3& place_from_other) {
  const PlaceFeature& feature = place.features[index];
  LikestFeature likest(place.descriptors.ptr(static_cast<int>(index)));
  for (size_t i = 0; i < other.features.size(); ++i) {
    const PlaceFeature& candidate = other.features[i];
    if (candidate.camera != feature.camera) continue;
    const Eigen::Vector3d baseline = place_from_other * candidate.origin - feature.origin;
    const Eigen::Vector3d normal = baseline.cross(feature.bearing);
    const double size = normal.norm();
    if (size < 0.02) continue;  // [m] no parallax along the way of the car
    const Eigen::Vector3d bearing = place_from_other.rotation * candidate.bearing;
    const double sigma = feature.sigma + candidate.sigma + kExtraSigma;
    if (std::abs(normal.dot(bearing)) <= kMaxOffPlane * sigma * size) likest.Look(other, i);
  }
  return likest.Found(kMaxHamming, kRatio);
}

void TriangulateFeature(std::span<const Place> places, size_t index, size_t i, const PlaceOptions& options,
                        PlaceFeature& feature) {
  const Place& place = places[index];
  std::vector<SightRay> rays = {{feature.origin, feature.bearing, feature.sigma + kExtraSigma}};
  const size_t first = index - std::min(index, kNeighbourPlaces),
               last = std::min(index + kNeighbourPlaces, places.size() - 1);
  for (size_t other = first; other <= last; ++other) {
    if (other == index) continue;
    const Rigid3 place_from_other = place.odom_from_place.Inverse() * places[other].odom_from_place;
    const std::optional<size_t> match = FindAlong(place, i, places[other], place_from_other);
    if (!match) continue;
    const PlaceFeature& seen = places[other].features[*match];
    rays.push_back(
        {place_from_other * seen.origin, place_from_other.rotation * seen.bearing, seen.sigma + kExtraSigma});
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

std::vector<PlaceFeature> TriangulateFeatures(const std::vector<Place>& places, size_t index,
                                              const PlaceOptions& options) {
  std::vector<PlaceFeature> features = places[index].features;
  for (size_t i = 0; i < features.size(); ++i) TriangulateFeature(places, index, i, options, features[i]);
  return features;
}

}  // namespace parkade
