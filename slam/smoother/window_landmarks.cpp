#include "slam/smoother/window_landmarks.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>

#include "slam/factors/measurement_model.h"
#include "slam/factors/triangulate.h"

namespace parkade {
namespace {

constexpr int kMinObservations = 3;

bool StartLandmark(Track& track) {
  std::vector<ObservationRay> rays;
  for (const TrackObservation& seen : track.observations) {
    const Rigid3 odom_from_camera = seen.view->geometry.OdomFromCamera(seen.bearing.row);
    rays.push_back({odom_from_camera.translation,
                    odom_from_camera.rotation * seen.bearing.direction, seen.bearing.sigma});
  }
  const std::optional<Triangulated> point = Triangulate(rays, kMaxStartError, kMinLandmarkDistance);
  if (!point) return false;
  track.has_landmark = true;
  track.ray = LandmarkRay(rays.front().origin, rays.front().direction);
  track.landmark = {0, 0, point->inverse_distance};
  for (TrackObservation& seen : track.observations)
    seen.cost = std::make_unique<BearingCost>(&seen.view->geometry, &track.ray, seen.bearing);
  return true;
}

void Restart(Track& track) {
  track.has_landmark = false;
  track.observations.clear();
  ++track.num_rejections;
}

/// False where nothing is left of the landmark.
bool RejectOutliersOf(Track& track) {
  if (track.landmark[2] < 0) track.landmark[2] = 0;
  if (track.landmark[2] > 1 / kMinLandmarkDistance || !std::isfinite(track.landmark[2]))
    return false;
  std::erase_if(track.observations, [&](const TrackObservation& seen) {
    return IsOutlier(seen.view->geometry, track.ray, track.landmark.data(), seen.bearing);
  });
  if (track.observations.size() < 2) return false;
  Rebase(track.ray, track.landmark.data());
  return true;
}

}  // namespace

void StartLandmarks(int max_landmarks, SmootherWindow& window) {
  std::vector<const WindowView*> newest(window.cameras.size(), nullptr);
  for (const WindowView& view : window.views) newest[static_cast<size_t>(view.camera)] = &view;
  const auto num_seeing =
      std::count_if(newest.begin(), newest.end(), [](const WindowView* view) { return view; });
  if (num_seeing == 0) return;
  const auto is_seen_now = [&](const Track& track) {
    return !track.observations.empty() &&
           (track.observations.back().view == newest[static_cast<size_t>(track.camera)] ||
            track.observations.back().view->camera != track.camera);
  };
  std::vector<long> budget(newest.size(), max_landmarks / num_seeing);
  std::vector<Track*> candidates;
  for (auto& [number, track] : window.tracks) {
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

void RejectOutliers(SmootherWindow& window) {
  for (auto& [number, track] : window.tracks)
    if (track.has_landmark && !RejectOutliersOf(track)) Restart(track);
}

std::optional<FinishedLandmark> FinishLandmark(const SmootherWindow& window, const Track& track) {
  const double inverse_distance = track.landmark[2];
  if (inverse_distance <= 0) return std::nullopt;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (const TrackObservation& seen : track.observations) {
    std::vector<const double*> parameters;
    for (const StateName& name : StatesOf(*seen.view)) parameters.push_back(window.ValuesOf(name));
    parameters.push_back(track.landmark.data());
    Eigen::Matrix<double, 2, kLandmarkSize, Eigen::RowMajor> jacobian;
    double residual[2];
    std::vector<double*> jacobians(parameters.size(), nullptr);
    jacobians.back() = jacobian.data();
    if (!seen.cost->Evaluate(parameters.data(), residual, jacobians.data())) return std::nullopt;
    information += jacobian.transpose() * jacobian;
  }
  const double determinant = information.determinant();
  if (!(determinant > 0)) return std::nullopt;
  const double inverse_distance_sigma = std::sqrt(information.inverse()(2, 2));
  const double sigma = inverse_distance_sigma / (inverse_distance * inverse_distance);
  if (!std::isfinite(sigma)) return std::nullopt;
  return FinishedLandmark{window.nodes.front().number,
                          track.first_time,
                          track.camera,
                          track.ray.Point(track.landmark.data()),
                          sigma,
                          track.num_consumed + static_cast<int>(track.observations.size())};
}

}  // namespace parkade
