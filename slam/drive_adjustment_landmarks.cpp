// Landmarks of DriveAdjustment: which tracks become one, where they begin, and what they lose.
#include <algorithm>
#include <map>

#include "slam/drive_adjustment_parts.h"
#include "slam/triangulate.h"

namespace parkade {
namespace {

constexpr double kStartError = 10;       // [sigma] of rays that may still become a landmark
constexpr size_t kMinSightingsLeft = 3;  // of a landmark that loses some
constexpr double kRebaseTangent = 0.1;   // [a b] beyond which a landmark gets a new ray

/// Where a track was seen: image and place among its sightings.
struct Seen {
  size_t image = 0, sighting = 0;
};

/// Tracks worth a landmark, the longest first, as long as one of their images has not got enough.
std::vector<std::vector<Seen>> ChooseTracks(const DriveMeasurements& measurements, const RefinementOptions& options) {
  std::map<std::int64_t, std::vector<Seen>> tracks;
  for (size_t i = 0; i < measurements.images.size(); ++i)
    for (size_t k = 0; k < measurements.images[i].sightings.size(); ++k)
      tracks[measurements.images[i].sightings[k].track].push_back({i, k});
  std::vector<const std::vector<Seen>*> candidates;
  for (const auto& [number, seen] : tracks)
    if (seen.size() >= static_cast<size_t>(options.min_sightings)) candidates.push_back(&seen);
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto* a, const auto* b) { return a->size() > b->size(); });
  std::vector<int> taken(measurements.images.size());
  std::vector<std::vector<Seen>> chosen;
  for (const std::vector<Seen>* track : candidates) {
    if (std::none_of(track->begin(), track->end(),
                     [&](const Seen& seen) { return taken[seen.image] < options.bearings_per_image; }))
      continue;
    for (const Seen& seen : *track) ++taken[seen.image];
    chosen.push_back(*track);
  }
  return chosen;
}

}  // namespace

void DriveAdjustment::AddLandmarks(const DriveMeasurements& measurements) {
  const std::vector<std::vector<Seen>> tracks = ChooseTracks(measurements, options_);
  landmarks_.reserve(tracks.size());  // costs point at their rays
  for (const std::vector<Seen>& track : tracks) {
    Landmark landmark;
    for (const Seen& seen : track) {
      const RecordedImage& image = measurements.images[seen.image];
      const RecordedSighting& sighting = image.sightings[seen.sighting];
      const double scale =
          options_.bearing_inflation * measurements.camera_noise_scales[static_cast<size_t>(image.camera)];
      landmark.sightings.push_back(
          {seen.image, {sighting.bearing.cast<double>().normalized(), scale * sighting.sigma, sighting.row}, nullptr});
    }
    std::array<double, kLandmarkSize> begin{};
    landmark.values = begin.data();
    if (!Triangulate(landmark)) continue;
    values_.insert(values_.end(), begin.begin(), begin.end());
    landmark.values = values_.data() + values_.size() - kLandmarkSize;
    landmarks_.push_back(std::move(landmark));
    Landmark& added = landmarks_.back();
    for (Sighting& sighting : added.sightings)
      sighting.cost = std::make_unique<BearingCost>(&images_[sighting.image].geometry, &added.ray, sighting.bearing);
  }
}

bool DriveAdjustment::Triangulate(Landmark& landmark) const {
  std::vector<SightRay> rays;
  for (const Sighting& sighting : landmark.sightings) {
    const Rigid3 odom_from_camera = images_[sighting.image].geometry.OdomFromCamera(sighting.bearing.row);
    rays.push_back(
        {odom_from_camera.translation, odom_from_camera.rotation * sighting.bearing.direction, sighting.bearing.sigma});
  }
  const std::optional<Triangulated> point = parkade::Triangulate(rays, kStartError, options_.min_distance);
  if (!point) return false;
  landmark.ray = LandmarkRay(rays.front().origin, rays.front().direction);
  landmark.values[0] = landmark.values[1] = 0;
  landmark.values[2] = point->inverse_distance;
  return true;
}

void DriveAdjustment::RejectOutliers() {
  PointImages();
  const double limit = options_.max_bearing_error * options_.max_bearing_error;
  for (Landmark& landmark : landmarks_) {
    double* values = landmark.values;
    values[2] = std::max(values[2], 0.0);
    const bool is_near = values[2] > 1 / options_.min_distance;
    std::erase_if(landmark.sightings, [&](const Sighting& sighting) {
      const Eigen::Vector3d direction =
          LandmarkInCamera(images_[sighting.image].geometry, landmark.ray, values, sighting.bearing.row);
      const Eigen::Vector2d error =
          sighting.bearing.basis.transpose() * direction.normalized() / sighting.bearing.sigma;
      return is_near || !(direction.dot(sighting.bearing.direction) > 0 && error.squaredNorm() < limit);
    });
    if (landmark.sightings.size() < kMinSightingsLeft) landmark.sightings.clear();
    const Eigen::Vector3d ray = landmark.ray.Ray(values);
    if (Eigen::Map<const Eigen::Vector2d>(values).norm() > kRebaseTangent) {
      landmark.ray = LandmarkRay(landmark.ray.origin, ray);
      values[0] = values[1] = 0;
      values[2] /= ray.norm();
    }
  }
}

}  // namespace parkade
