// Landmarks of FixedLagSmoother: from the first triangulation to the last look.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "slam/factors/triangulate.h"
#include "slam/smoother/fixed_lag_smoother.h"

namespace parkade {
namespace {

constexpr int kMinObservations = 3;
constexpr double kStartError = 10;      // [sigma] of rays that may still become a landmark
constexpr double kRebaseTangent = 0.1;  // [a b] beyond which a landmark gets a new ray

}  // namespace

Bearing FixedLagSmoother::BearingOf(const FeatureObservation& seen, int camera) const {
  const auto index = static_cast<size_t>(camera);
  return Bearing(seen.bearing, seen.sigma * camera_noise_scales_[index],
                 seen.pixel.y() - camera_settings_[index].middle_row);
}

bool FixedLagSmoother::StartLandmark(Track& track) {
  std::vector<ObservationRay> rays;
  for (const TrackObservation& seen : track.observations) {
    const Rigid3 odom_from_camera = seen.view->geometry.OdomFromCamera(seen.bearing.row);
    rays.push_back({odom_from_camera.translation,
                    odom_from_camera.rotation * seen.bearing.direction, seen.bearing.sigma});
  }
  const std::optional<Triangulated> point = Triangulate(rays, kStartError, options_.min_distance);
  if (!point) return false;
  track.has_landmark = true;
  track.ray = LandmarkRay(rays.front().origin, rays.front().direction);
  track.landmark = {0, 0, point->inverse_distance};
  for (TrackObservation& seen : track.observations)
    seen.cost = std::make_unique<BearingCost>(&seen.view->geometry, &track.ray, seen.bearing);
  return true;
}

void FixedLagSmoother::StartLandmarks() {
  std::vector<const WindowView*> newest(cameras_.size(), nullptr);
  for (const WindowView& view : views_) newest[static_cast<size_t>(view.camera)] = &view;
  const auto num_seeing =
      std::count_if(newest.begin(), newest.end(), [](const WindowView* view) { return view; });
  if (num_seeing == 0) return;
  const auto is_seen_now = [&](const Track& track) {
    return !track.observations.empty() &&
           (track.observations.back().view == newest[static_cast<size_t>(track.camera)] ||
            track.observations.back().view->camera != track.camera);
  };
  std::vector<long> budget(newest.size(), options_.landmarks / num_seeing);
  std::vector<Track*> candidates;
  for (auto& [number, track] : tracks_) {
    if (!is_seen_now(track)) continue;
    if (track.has_landmark)
      --budget[static_cast<size_t>(track.camera)];
    else if (track.observations.size() >= kMinObservations)
      candidates.push_back(&track);
  }
  std::stable_sort(candidates.begin(), candidates.end(), [](const Track* a, const Track* b) {
    return a->observations.size() > b->observations.size();
  });
  for (Track* track : candidates) {
    long& left = budget[static_cast<size_t>(track->camera)];
    if (left > 0 && StartLandmark(*track)) --left;
  }
}

void FixedLagSmoother::Restart(Track& track) {
  track.has_landmark = false;
  track.observations.clear();
  ++track.num_rejections;
}

bool FixedLagSmoother::RejectOutliersOf(Track& track) {
  if (track.landmark[2] < 0) track.landmark[2] = 0;
  if (track.landmark[2] > 1 / options_.min_distance || !std::isfinite(track.landmark[2]))
    return false;
  const double limit = options_.max_bearing_error * options_.max_bearing_error;
  std::erase_if(track.observations, [&](const TrackObservation& seen) {
    const Eigen::Vector3d direction =
        LandmarkInCamera(seen.view->geometry, track.ray, track.landmark.data(), seen.bearing.row);
    const Eigen::Vector2d error =
        seen.bearing.basis.transpose() * direction.normalized() / seen.bearing.sigma;
    return !(direction.dot(seen.bearing.direction) > 0 && error.squaredNorm() < limit);
  });
  if (track.observations.size() < 2) return false;
  const Eigen::Vector3d ray = track.ray.Ray(track.landmark.data());
  if (Eigen::Map<const Eigen::Vector2d>(track.landmark.data()).norm() > kRebaseTangent) {
    track.landmark = {0, 0, track.landmark[2] / ray.norm()};
    track.ray = LandmarkRay(track.ray.origin, ray);
  }
  return true;
}

void FixedLagSmoother::RejectOutliers() {
  for (auto& [number, track] : tracks_)
    if (track.has_landmark && !RejectOutliersOf(track)) Restart(track);
}

void FixedLagSmoother::FinishLandmark(const Track& track) {
  const double inverse_distance = track.landmark[2];
  if (inverse_distance <= 0) return;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (const TrackObservation& seen : track.observations) {
    std::vector<const double*> parameters;
    for (const StateName& name : StatesOf(*seen.view)) parameters.push_back(ValuesOf(name));
    parameters.push_back(track.landmark.data());
    Eigen::Matrix<double, 2, kLandmarkSize, Eigen::RowMajor> jacobian;
    double residual[2];
    std::vector<double*> jacobians(parameters.size(), nullptr);
    jacobians.back() = jacobian.data();
    if (!seen.cost->Evaluate(parameters.data(), residual, jacobians.data())) return;
    information += jacobian.transpose() * jacobian;
  }
  const double determinant = information.determinant();
  if (!(determinant > 0)) return;
  const double inverse_distance_sigma = std::sqrt(information.inverse()(2, 2));
  const double sigma = inverse_distance_sigma / (inverse_distance * inverse_distance);
  if (!std::isfinite(sigma)) return;
  finished_landmarks_.push_back({nodes_.front().number, track.first_time, track.camera,
                                 track.ray.Point(track.landmark.data()), sigma,
                                 track.num_consumed + static_cast<int>(track.observations.size())});
}

}  // namespace parkade
