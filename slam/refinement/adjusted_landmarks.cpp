#include "slam/refinement/adjusted_landmarks.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/math/decompositions.h"
#include "core/parallel.h"
#include "slam/factors/measurement_model.h"
#include "slam/factors/triangulate.h"

namespace parkade {
namespace {

constexpr size_t kMinObservationsLeft = 3;  // of a landmark that loses some
constexpr int kFitSteps = 3;

/// At most `count` of `seen`, evenly spread, the first and the last among them.
ChosenTrack Thinned(const ChosenTrack& seen, size_t count) {
  if (seen.size() <= count) return seen;
  ChosenTrack thinned;
  for (size_t i = 0; i < count; ++i) thinned.push_back(seen[i * (seen.size() - 1) / (count - 1)]);
  return thinned;
}

/// Puts the landmark where its bearings meet; false where they meet nowhere.
bool Triangulate(const AdjustedDrive& drive, AdjustedLandmark& landmark) {
  std::vector<ObservationRay> rays;
  for (const AdjustedObservation& observation : landmark.observations) {
    const Rigid3 odom_from_camera =
        drive.images[observation.image].geometry.OdomFromCamera(observation.bearing.row);
    rays.push_back({odom_from_camera.translation,
                    odom_from_camera.rotation * observation.bearing.direction,
                    observation.bearing.sigma});
  }
  const std::optional<Triangulated> point =
      parkade::Triangulate(rays, kMaxStartError, kMinLandmarkDistance);
  if (!point) return false;
  landmark.ray = LandmarkRay(rays.front().origin, rays.front().direction);
  landmark.values[0] = landmark.values[1] = 0;
  landmark.values[2] = point->inverse_distance;
  return true;
}

void FitLandmark(const AdjustedDrive& drive, AdjustedLandmark& landmark) {
  for (int step = 0; step < kFitSteps; ++step) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const AdjustedObservation& observation : landmark.observations) {
      std::vector<double*> blocks = drive.images[observation.image].geometry.Blocks();
      blocks.push_back(landmark.values);
      Eigen::Vector2d residual;
      Eigen::Matrix<double, 2, kLandmarkSize, Eigen::RowMajor> jacobian;
      std::vector<double*> jacobians(blocks.size(), nullptr);
      jacobians.back() = jacobian.data();
      if (!observation.cost->Evaluate(blocks.data(), residual.data(), jacobians.data())) return;
      const double weight = 1 / (1 + residual.squaredNorm() / (kRobustWidth * kRobustWidth));
      normal += weight * jacobian.transpose() * jacobian;
      right -= weight * jacobian.transpose() * residual;
    }
    const Eigen::Vector3d change = SolveSymmetric(normal, right);
    if (!change.allFinite()) return;
    Eigen::Map<Eigen::Vector3d>(landmark.values) += change;
    landmark.values[2] = std::max(landmark.values[2], 0.0);
  }
}

}  // namespace

std::vector<ChosenTrack> ChooseTracks(const DriveMeasurements& measurements,
                                      const RefinementOptions& options) {
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
    if (std::none_of(track->begin(), track->end(), [&](const TrackInImage& seen) {
          return taken[seen.image] < options.bearings_per_image;
        }))
      continue;
    for (const TrackInImage& seen : *track) ++taken[seen.image];
    chosen.push_back(std::move(*track));
  }
  return chosen;
}

void AddLandmarks(const DriveMeasurements& measurements, const std::vector<ChosenTrack>& tracks,
                  AdjustedDrive& drive) {
  struct Needed {
    std::uint32_t observation, track;
  };
  std::vector<std::vector<Needed>> needed(drive.images.size());  // of each image: read once
  for (std::uint32_t t = 0; t < tracks.size(); ++t)
    for (const TrackInImage& seen : tracks[t]) needed[seen.image].push_back({seen.observation, t});
  std::vector<AdjustedLandmark> candidates(tracks.size());
  for (size_t i = 0; i < drive.images.size(); ++i) {
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
  drive.landmarks.reserve(tracks.size());  // costs point at their rays
  for (AdjustedLandmark& landmark : candidates) {
    std::array<double, kLandmarkSize> begin{};
    landmark.values = begin.data();
    if (!Triangulate(drive, landmark)) continue;
    landmark.values = drive.arena.Add(begin);
    drive.landmarks.push_back(std::move(landmark));
    AdjustedLandmark& added = drive.landmarks.back();
    for (AdjustedObservation& observation : added.observations)
      observation.cost = std::make_unique<BearingCost>(&drive.images[observation.image].geometry,
                                                       &added.ray, observation.bearing);
  }
}

void TriangulateLandmarks(AdjustedDrive& drive) {
  for (AdjustedLandmark& landmark : drive.landmarks)
    if (!landmark.observations.empty()) Triangulate(drive, landmark);
}

void HoldOutLandmarks(size_t every, AdjustedDrive& drive) {
  for (size_t i = 0; i < drive.landmarks.size(); ++i)
    drive.landmarks[i].is_used = every == 0 || i % every != every / 2;
}

void FitLandmarks(AdjustedDrive& drive) {
  drive.PointImages();
  ParallelFor(drive.landmarks.size(),
              [&drive](size_t i) { FitLandmark(drive, drive.landmarks[i]); });
}

double RobustErrorOf(const AdjustedDrive& drive, const AdjustedLandmark& landmark) {
  const double width_squared = kRobustWidth * kRobustWidth;
  double sum = 0;
  for (const AdjustedObservation& observation : landmark.observations) {
    std::vector<double*> blocks = drive.images[observation.image].geometry.Blocks();
    blocks.push_back(landmark.values);
    Eigen::Vector2d residual;
    if (observation.cost->Evaluate(blocks.data(), residual.data(), nullptr))
      sum += 0.5 * width_squared * std::log1p(residual.squaredNorm() / width_squared);
  }
  return sum;
}

void RejectOutliers(AdjustedDrive& drive) {
  drive.PointImages();
  for (AdjustedLandmark& landmark : drive.landmarks) {
    if (!landmark.is_used) continue;
    double* values = landmark.values;
    values[2] = std::max(values[2], 0.0);
    const bool is_near = values[2] > 1 / kMinLandmarkDistance;
    std::erase_if(landmark.observations, [&](const AdjustedObservation& seen) {
      return is_near ||
             IsOutlier(drive.images[seen.image].geometry, landmark.ray, values, seen.bearing);
    });
    if (landmark.observations.size() < kMinObservationsLeft) landmark.observations.clear();
    Rebase(landmark.ray, values);
  }
}

}  // namespace parkade
