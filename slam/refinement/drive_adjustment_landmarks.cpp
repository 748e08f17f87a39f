// Landmarks of DriveAdjustment: which tracks become one, where they begin, and what they lose.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

#include "slam/factors/triangulate.h"
#include "slam/refinement/drive_adjustment.h"

namespace parkade {
namespace {

constexpr double kStartError = 10;          // [sigma] of rays that may still become a landmark
constexpr size_t kMinObservationsLeft = 3;  // of a landmark that loses some
constexpr int kFitSteps = 3;
constexpr double kRebaseTangent = 0.1;  // [a b] beyond which a landmark gets a new ray

/// At most `count` of `seen`, evenly spread, the first and the last among them.
template <typename SeenTrack>
std::vector<SeenTrack> Thinned(const std::vector<SeenTrack>& seen, size_t count) {
  if (seen.size() <= count) return seen;
  std::vector<SeenTrack> thinned;
  for (size_t i = 0; i < count; ++i) thinned.push_back(seen[i * (seen.size() - 1) / (count - 1)]);
  return thinned;
}

}  // namespace

/// Tracks worth a landmark, the longest first, as long as one of their images has not got enough.
std::vector<DriveAdjustment::ChosenTrack> DriveAdjustment::ChooseTracks(
    const DriveMeasurements& measurements, const RefinementOptions& options) {
  std::map<std::int64_t, ChosenTrack> tracks;
  for (std::uint32_t i = 0; i < measurements.num_images(); ++i) {
    std::uint32_t k = 0;
    for (const RecordedObservation& observation : measurements.Image(i).observations)
      tracks[observation.track].push_back({i, k++});
  }
  std::vector<ChosenTrack*> candidates;
  for (auto& [number, seen] : tracks) {
    if (seen.size() < static_cast<size_t>(options.min_observations)) continue;
    seen = Thinned(seen, static_cast<size_t>(options.observations_per_track));
    candidates.push_back(&seen);
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto* a, const auto* b) { return a->size() > b->size(); });
  std::vector<int> taken(measurements.num_images());
  std::vector<ChosenTrack> chosen;
  for (ChosenTrack* track : candidates) {
    if (std::none_of(track->begin(), track->end(), [&](const SeenTrack& seen) {
          return taken[seen.image] < options.bearings_per_image;
        }))
      continue;
    for (const SeenTrack& seen : *track) ++taken[seen.image];
    chosen.push_back(std::move(*track));
  }
  return chosen;
}

void DriveAdjustment::AddLandmarks(const DriveMeasurements& measurements,
                                   const std::vector<ChosenTrack>& tracks) {
  struct Needed {
    std::uint32_t observation, track;
  };
  std::vector<std::vector<Needed>> needed(images_.size());  // of each image: read once
  for (std::uint32_t t = 0; t < tracks.size(); ++t)
    for (const SeenTrack& seen : tracks[t]) needed[seen.image].push_back({seen.observation, t});
  std::vector<AdjustedLandmark> candidates(tracks.size());
  for (size_t i = 0; i < images_.size(); ++i) {
    if (needed[i].empty()) continue;
    const RecordedImage image = measurements.Image(i);
    const double scale = measurements.shared.camera_noise_scales[static_cast<size_t>(image.camera)];
    for (const Needed& need : needed[i]) {
      const RecordedObservation& observation = image.observations[need.observation];
      candidates[need.track].observations.push_back(
          {i,
           {observation.bearing.cast<double>().normalized(), scale * observation.sigma,
            observation.row},
           nullptr});
    }
  }
  landmarks_.reserve(tracks.size());  // costs point at their rays
  for (AdjustedLandmark& landmark : candidates) {
    std::array<double, kLandmarkSize> begin{};
    landmark.values = begin.data();
    if (!Triangulate(landmark)) continue;
    values_.insert(values_.end(), begin.begin(), begin.end());
    landmark.values = values_.data() + values_.size() - kLandmarkSize;
    landmarks_.push_back(std::move(landmark));
    AdjustedLandmark& added = landmarks_.back();
    for (LandmarkObservation& observation : added.observations)
      observation.cost = std::make_unique<BearingCost>(&images_[observation.image].geometry,
                                                       &added.ray, observation.bearing);
  }
}

bool DriveAdjustment::Triangulate(AdjustedLandmark& landmark) const {
  std::vector<ObservationRay> rays;
  for (const LandmarkObservation& observation : landmark.observations) {
    const Rigid3 odom_from_camera =
        images_[observation.image].geometry.OdomFromCamera(observation.bearing.row);
    rays.push_back({odom_from_camera.translation,
                    odom_from_camera.rotation * observation.bearing.direction,
                    observation.bearing.sigma});
  }
  const std::optional<Triangulated> point =
      parkade::Triangulate(rays, kStartError, options_.min_distance);
  if (!point) return false;
  landmark.ray = LandmarkRay(rays.front().origin, rays.front().direction);
  landmark.values[0] = landmark.values[1] = 0;
  landmark.values[2] = point->inverse_distance;
  return true;
}

void DriveAdjustment::HoldOutLandmarks(size_t every) {
  for (size_t i = 0; i < landmarks_.size(); ++i)
    landmarks_[i].is_used = every == 0 || i % every != every / 2;
}

void DriveAdjustment::FitLandmark(AdjustedLandmark& landmark) const {
  for (int step = 0; step < kFitSteps; ++step) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const LandmarkObservation& observation : landmark.observations) {
      std::vector<double*> blocks = BlocksOf(images_[observation.image]);
      blocks.push_back(landmark.values);
      Eigen::Vector2d residual;
      Eigen::Matrix<double, 2, kLandmarkSize, Eigen::RowMajor> jacobian;
      std::vector<double*> jacobians(blocks.size(), nullptr);
      jacobians.back() = jacobian.data();
      if (!observation.cost->Evaluate(blocks.data(), residual.data(), jacobians.data())) return;
      const double weight =
          1 / (1 + residual.squaredNorm() / (options_.robust_width * options_.robust_width));
      normal += weight * jacobian.transpose() * jacobian;
      right -= weight * jacobian.transpose() * residual;
    }
    const Eigen::Vector3d change = normal.ldlt().solve(right);
    if (!change.allFinite()) return;
    Eigen::Map<Eigen::Vector3d>(landmark.values) += change;
    landmark.values[2] = std::max(landmark.values[2], 0.0);
  }
}

void DriveAdjustment::FitLandmarks() {
  PointImages();
  for (AdjustedLandmark& landmark : landmarks_) FitLandmark(landmark);
}

double DriveAdjustment::RobustErrorOf(const AdjustedLandmark& landmark) const {
  const double width_squared = options_.robust_width * options_.robust_width;
  double sum = 0;
  for (const LandmarkObservation& observation : landmark.observations) {
    std::vector<double*> blocks = BlocksOf(images_[observation.image]);
    blocks.push_back(landmark.values);
    Eigen::Vector2d residual;
    if (observation.cost->Evaluate(blocks.data(), residual.data(), nullptr))
      sum += 0.5 * width_squared * std::log1p(residual.squaredNorm() / width_squared);
  }
  return sum;
}

void DriveAdjustment::RejectOutliers() {
  PointImages();
  const double limit = options_.max_bearing_error * options_.max_bearing_error;
  for (AdjustedLandmark& landmark : landmarks_) {
    if (!landmark.is_used) continue;
    double* values = landmark.values;
    values[2] = std::max(values[2], 0.0);
    const bool is_near = values[2] > 1 / options_.min_distance;
    std::erase_if(landmark.observations, [&](const LandmarkObservation& observation) {
      const Eigen::Vector3d direction = LandmarkInCamera(
          images_[observation.image].geometry, landmark.ray, values, observation.bearing.row);
      const Eigen::Vector2d error = observation.bearing.basis.transpose() * direction.normalized() /
                                    observation.bearing.sigma;
      return is_near ||
             !(direction.dot(observation.bearing.direction) > 0 && error.squaredNorm() < limit);
    });
    if (landmark.observations.size() < kMinObservationsLeft) landmark.observations.clear();
    const Eigen::Vector3d ray = landmark.ray.Ray(values);
    if (Eigen::Map<const Eigen::Vector2d>(values).norm() > kRebaseTangent) {
      landmark.ray = LandmarkRay(landmark.ray.origin, ray);
      values[0] = values[1] = 0;
      values[2] /= ray.norm();
    }
  }
}

}  // namespace parkade
