#include "slam/initialization/start_problem.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

namespace parkade {
namespace {

constexpr double kImagesPerCamera = 24;     // of tracks that last; more would not tell more
constexpr double kMinImageInterval = 0.08;  // [s]
constexpr size_t kLongTracks = 70, kNearTracks = 30, kLowTracks = 30;  // of a camera
constexpr size_t kMinObservations = 3, kMinLowObservations = 2;
constexpr double kMinBiasSigma = 1e-4;  // [rad/s]

/// Carries an image's derivatives along from one instant to the next.
class Integration {
 public:
  Integration(const ImuBuffer& imu, const ImuCalibration& calibration, const ImuBias& bias,
              Timestamp begin)
      : imu_(imu), calibration_(calibration), bias_(bias), begin_(begin), now_(begin) {}

  void AdvanceTo(Timestamp time) {
    if (!(now_ < time)) return;
    const ImuPreintegration next(imu_.Between(now_, time), bias_, calibration_);
    const MotionIncrement& step = next.increment();
    const Eigen::Matrix3d rotation = rotation_, turn = step.rotation.toRotationMatrix();
    const auto carry = [&](Derivatives& by, const Eigen::Matrix<double, 9, 3>& own) {
      by.position += by.velocity * step.duration - rotation * Skew(step.position) * by.rotation +
                     rotation * own.bottomRows<3>();
      by.velocity +=
          -rotation * Skew(step.velocity) * by.rotation + rotation * own.middleRows<3>(3);
      by.rotation = turn.transpose() * by.rotation + own.topRows<3>();
    };
    carry(by_gyroscope_, next.d_gyroscope());
    carry(by_accelerometer_, next.d_accelerometer());
    position_ += velocity_ * step.duration + rotation * step.position;
    velocity_ += rotation * step.velocity;
    rotation_ = rotation * turn;
    now_ = time;
  }

  StartImage Image(int camera, const Eigen::Vector3d& camera_in_imu) const {
    return {now_ - begin_,
            camera,
            camera_in_imu,
            rotation_,
            position_,
            by_gyroscope_.rotation,
            by_gyroscope_.position,
            by_accelerometer_.position};
  }

  const Eigen::Vector3d& velocity() const { return velocity_; }

 private:
  struct Derivatives {
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Zero(), velocity = rotation, position = rotation;
  };

  const ImuBuffer& imu_;
  const ImuCalibration& calibration_;
  ImuBias bias_;
  Timestamp begin_, now_;
  Eigen::Matrix3d rotation_ = Eigen::Matrix3d::Identity();
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero(), position_ = Eigen::Vector3d::Zero();
  Derivatives by_gyroscope_, by_accelerometer_;
};

/// [rad] by which a track moves beyond rotation.
double ParallaxAngle(const StartTrack& track, const StartProblem& problem) {
  const StartObservation &first = track.observations.front(), &last = track.observations.back();
  return (problem.images[first.image].rotation * first.bearing)
      .cross(problem.images[last.image].rotation * last.bearing)
      .norm();
}

/// Moves the `count` tracks of most `value` to the end of `kept`.
template <typename Value>
void TakeMost(std::vector<StartTrack>& tracks, size_t count, const Value& value,
              std::vector<StartTrack>& kept) {
  std::stable_sort(tracks.begin(), tracks.end(),
                   [&](const StartTrack& a, const StartTrack& b) { return value(a) > value(b); });
  const auto end = tracks.begin() + static_cast<std::ptrdiff_t>(std::min(count, tracks.size()));
  std::move(tracks.begin(), end, std::back_inserter(kept));
  tracks.erase(tracks.begin(), end);
}

/// Tracks are taken for the camera that saw them first: those with most observations; of the others
/// those that move most, which are near, and those that look down most: a fast car sees the ground,
/// which may tell the scale, for a moment only, sometimes in two images.
std::vector<StartTrack> TracksToUse(std::map<std::int64_t, StartTrack>&& tracks,
                                    const StartProblem& problem, const Rig& rig) {
  const Eigen::Vector3d down_in_imu =
      rig.body_from_imu.rotation.conjugate() * -Eigen::Vector3d::UnitZ();
  const auto is_for_all = [&](const StartObservation& seen) {
    return problem.images[seen.image].is_for_all;
  };
  const auto length = [&](const StartTrack& track) {
    return static_cast<size_t>(
        std::count_if(track.observations.begin(), track.observations.end(), is_for_all));
  };
  std::vector<std::vector<StartTrack>> of_camera(rig.cameras.size()), brief = of_camera;
  for (auto& [number, track] : tracks) {
    if (track.observations.size() < kMinLowObservations) continue;
    const auto camera =
        static_cast<size_t>(problem.images[track.observations.front().image].camera);
    (length(track) < kMinObservations ? brief : of_camera)[camera].push_back(std::move(track));
  }
  std::vector<StartTrack> kept;
  for (size_t camera = 0; camera < of_camera.size(); ++camera) {
    std::vector<StartTrack>& all = of_camera[camera];
    const size_t num_before = kept.size();
    TakeMost(all, kLongTracks, length, kept);
    TakeMost(
        all, kNearTracks, [&](const StartTrack& track) { return ParallaxAngle(track, problem); },
        kept);
    for (size_t i = num_before; i < kept.size(); ++i)
      std::erase_if(kept[i].observations, std::not_fn(is_for_all));
    if (!rig.vehicle) continue;
    std::move(brief[camera].begin(), brief[camera].end(), std::back_inserter(all));
    TakeMost(
        all, kLowTracks,
        [&](const StartTrack& track) {
          return track.observations.front().bearing.dot(down_in_imu);
        },
        kept);
  }
  return kept;
}

}  // namespace

StartProblem CollectStartProblem(const ImuBuffer& imu, const std::vector<TrackedFrame>& frames,
                                 const Rig& rig, const GyroscopeBiasEstimate& bias, Timestamp begin,
                                 Timestamp end) {
  StartProblem problem;
  problem.duration = end - begin;
  problem.linearized_at = {bias.bias, Eigen::Vector3d::Zero()};
  problem.gyroscope = {bias.bias, std::max(bias.sigma, kMinBiasSigma)};
  const double interval = std::max(kMinImageInterval, problem.duration / kImagesPerCamera);
  std::map<std::int64_t, StartTrack> tracks;
  std::vector<Timestamp> last_used(rig.cameras.size(), begin - 1e3), last_for_all = last_used;
  Integration integration(imu, rig.imu, problem.linearized_at, begin);
  for (const TrackedFrame& frame : frames) {
    const auto camera = static_cast<size_t>(frame.camera);
    if (frame.time < begin || frame.time > end ||
        frame.time - last_used[camera] < kMinImageInterval)
      continue;
    const bool is_for_all = frame.time - last_for_all[camera] >= interval;
    if (!is_for_all && !rig.vehicle) continue;
    last_used[camera] = frame.time;
    if (is_for_all) last_for_all[camera] = frame.time;
    integration.AdvanceTo(frame.time);
    const Rigid3 imu_from_camera = rig.ImuFromCamera(camera);
    problem.images.push_back(integration.Image(frame.camera, imu_from_camera.translation));
    problem.images.back().is_for_all = is_for_all;
    for (const FeatureObservation& seen : frame.observations)
      tracks[seen.track].observations.push_back(
          {problem.images.size() - 1, imu_from_camera.rotation * seen.bearing, seen.sigma});
  }
  integration.AdvanceTo(end);
  problem.end = integration.Image(0, Eigen::Vector3d::Zero());
  problem.force = integration.velocity();
  problem.tracks = TracksToUse(std::move(tracks), problem, rig);
  return problem;
}

Eigen::Vector3d SteadyGravity(const StartProblem& problem, const Eigen::Vector3d& velocity) {
  const Eigen::Vector3d gained = problem.end.rotation * velocity - velocity;
  return kGravityInOdom.norm() * (gained - problem.force).normalized();
}

}  // namespace parkade
