#include "slam/sessions/cut_into_submaps.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "slam/places/place.h"

namespace parkade {
namespace {

/// [m] driven at each state.
std::vector<double> DistancesAlong(const Trajectory& trajectory) {
  std::vector<double> distances;
  double distance = 0;
  for (size_t i = 0; i < trajectory.states().size(); ++i) {
    if (i > 0)
      distance +=
          (trajectory.states()[i].odom_from_body.translation - trajectory.states()[i - 1].odom_from_body.translation)
              .norm();
    distances.push_back(distance);
  }
  return distances;
}

double DistanceAt(const Trajectory& trajectory, const std::vector<double>& distances, Timestamp time) {
  const auto& states = trajectory.states();
  const auto after = std::lower_bound(states.begin(), states.end(), time,
                                      [](const TrajectoryState& state, Timestamp t) { return state.time < t; });
  return distances[std::min(static_cast<size_t>(after - states.begin()), distances.size() - 1)];
}

}  // namespace

void SubmapOptions::Validate() const {
  Require(length > 0 && max_landmark_sigma > 0, ErrorCode::kUsage,
          "the length of a submap and the sigma of its landmarks must be positive");
}

std::vector<Submap> CutIntoSubmaps(const OdometryResult& odometry, int drive, const SubmapOptions& options) {
  options.Validate();
  std::vector<Submap> submaps;
  if (odometry.keyframes.empty()) return submaps;
  const std::vector<double> distances = DistancesAlong(odometry.odom_from_body);
  const double begin = DistanceAt(odometry.odom_from_body, distances, odometry.keyframes.front().time);
  const double total = distances.back() - begin;
  const auto count = std::max(1L, std::lround(total / options.length));
  const auto index_at = [&](Timestamp time) {
    const double distance = DistanceAt(odometry.odom_from_body, distances, time) - begin;
    return std::clamp(static_cast<long>(std::floor(distance / options.length)), 0L, count - 1);
  };

  std::vector<long> index_of_submap;  // stretches without keyframes get no submap
  for (const OdometryKeyframe& keyframe : odometry.keyframes) {
    const long index = index_at(keyframe.time);
    if (index_of_submap.empty() || index > index_of_submap.back()) {
      index_of_submap.push_back(index);
      submaps.push_back({drive, LevelledPose(keyframe.odom_from_body), {}, {}});
    }
    Submap& submap = submaps.back();
    submap.keyframes.push_back(
        {keyframe.time, keyframe.camera, submap.odom_from_submap.Inverse() * keyframe.odom_from_body});
  }
  for (const OdometryLandmark& landmark : odometry.landmarks) {
    if (landmark.sigma > options.max_landmark_sigma) continue;
    const auto found = std::upper_bound(index_of_submap.begin(), index_of_submap.end(), index_at(landmark.time));
    Submap& submap = submaps[static_cast<size_t>(std::max<long>(0, found - index_of_submap.begin() - 1))];
    submap.landmarks.push_back(
        {submap.odom_from_submap.Inverse() * landmark.point_in_odom, landmark.sigma, landmark.num_observations});
  }
  return submaps;
}

}  // namespace parkade
