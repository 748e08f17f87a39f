#include "slam/refinement/image_residuals.h"

#include <cmath>
#include <limits>

#include "slam/refinement/adjusted_drive.h"
#include "slam/refinement/adjusted_landmarks.h"
#include "slam/smoother/drive_measurements.h"

namespace parkade {
namespace {

/// The states of the nodes where the trajectory has them.
std::vector<MotionState> StatesOn(const Trajectory& odom_from_body, const Rig& rig,
                                  const DriveMeasurements& measurements) {
  std::vector<MotionState> states;
  for (const RecordedNode& node : measurements.nodes) {
    MotionState& state = states.emplace_back(node.state);
    const std::optional<Rigid3> pose = odom_from_body.At(node.state.time);
    if (!pose) continue;
    const Rigid3 odom_from_imu = *pose * rig.body_from_imu;
    state.velocity_in_odom = odom_from_imu.rotation *
                             (state.odom_from_imu.rotation.conjugate() * state.velocity_in_odom);
    state.odom_from_imu = odom_from_imu;
  }
  return states;
}

void SetCameras(const Rig& log_rig, const Rig& rig, AdjustedDrive& drive) {
  for (size_t i = 0; i < drive.cameras.size(); ++i) {
    PoseToParameters(rig.ImuFromCamera(i), drive.cameras[i].extrinsics);
    drive.cameras[i].timing[0] = rig.cameras[i].time_shift - log_rig.cameras[i].time_shift;
    drive.cameras[i].timing[1] = rig.cameras[i].line_delay;
  }
  drive.PointImages();
}

/// [rad^2] of a bearing off its landmark.
double SquaredError(const AdjustedDrive& drive, const AdjustedLandmark& landmark,
                    const AdjustedObservation& observation) {
  std::vector<double*> blocks = drive.images[observation.image].geometry.Blocks();
  blocks.push_back(landmark.values);
  Eigen::Vector2d in_sigmas;
  if (!observation.cost->Evaluate(blocks.data(), in_sigmas.data(), nullptr)) return 0;
  const double sigma = observation.bearing.sigma;
  return in_sigmas.squaredNorm() * sigma * sigma;
}

}  // namespace

std::vector<ImageResidual> ResidualsOfImages(const DriveMeasurements& measurements,
                                             const Rig& log_rig, const Rig& rig,
                                             const Trajectory& odom_from_body,
                                             RefinementOptions options) {
  if (measurements.nodes.empty()) return {};
  // All of them: an image with few would else seem to be a bad one.
  options.observations_per_track = std::numeric_limits<int>::max();
  const std::vector<ChosenTrack> tracks = ChooseTracks(measurements, options);
  AdjustedDrive drive(measurements, StatesOn(odom_from_body, rig, measurements), tracks.size());
  SetCameras(log_rig, rig, drive);
  AddLandmarks(measurements, tracks, drive);
  FitLandmarks(drive);
  RejectOutliers(drive);
  std::vector<ImageResidual> residuals;
  for (size_t i = 0; i < measurements.num_images(); ++i) {
    const RecordedImage image = measurements.Image(i);
    residuals.push_back({image.time, image.camera});
  }
  for (const AdjustedLandmark& landmark : drive.landmarks)
    for (const AdjustedObservation& observation : landmark.observations) {
      ImageResidual& residual = residuals[observation.image];
      ++residual.num_inliers;
      residual.rms += SquaredError(drive, landmark, observation);
    }
  for (ImageResidual& residual : residuals)
    if (residual.num_inliers > 0) residual.rms = std::sqrt(residual.rms / residual.num_inliers);
  return residuals;
}

}  // namespace parkade
