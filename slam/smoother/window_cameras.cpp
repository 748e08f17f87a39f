#include "slam/smoother/window_cameras.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/math/decompositions.h"
#include "slam/factors/measurement_model.h"

namespace parkade {
namespace {

using Kind = StateName::Kind;

constexpr double kHeld = 1;  // sigma of what is not estimated: its Jacobians are zero
constexpr double kMinTranslationSigma = 1e-3;  // [m]
constexpr double kHeadRotation = 2e-5;         // [rad] of one camera against the other
constexpr double kHeadTranslation = 2e-4;      // of their distance
constexpr double kNoiseGain = 0.05;  // share of one solve in the estimate of a camera's noise
constexpr double kMinNoiseScale = 0.2, kMaxNoiseScale = 4;
constexpr int kMinErrorsForNoise = 40;
constexpr double kMedianOfChiSquared2 = 1.386;  // of a squared error of two unit-variance residuals

/// [m] from a camera to the nearest other one, or to the IMU where there is none: what
/// its place was measured against.
double ArmOf(const Rig& rig, size_t camera) {
  const Eigen::Vector3d own = rig.ImuFromCamera(camera).translation;
  double arm = rig.cameras.size() > 1 ? std::numeric_limits<double>::infinity() : own.norm();
  for (size_t i = 0; i < rig.cameras.size(); ++i)
    if (i != camera) arm = std::min(arm, (rig.ImuFromCamera(i).translation - own).norm());
  return arm;
}

/// Cameras of one head hardly move against each other.
void AddPriorOfPair(size_t i, size_t j, SmootherWindow& window) {
  const Rigid3 first = window.cameras[i].ImuFromCamera(),
               second = window.cameras[j].ImuFromCamera();
  const double distance = (first.translation - second.translation).norm();
  if (distance > kHeadSize || !window.camera_settings[i].has_extrinsics) return;
  const Eigen::Index width = window.prior.sqrt_information.cols();
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(width + kPoseTangentSize, width);
  rows.topRows(width) = window.prior.sqrt_information;
  const auto fill = [&](size_t camera, const Rigid3& imu_from_camera, double sign) {
    const Eigen::Index column =
        window.prior.ColumnOf({Kind::kExtrinsics, static_cast<std::int64_t>(camera)});
    rows.block<3, 3>(width, column) =
        sign / kHeadRotation * imu_from_camera.rotation.toRotationMatrix();
    rows.block<3, 3>(width + 3, column + 3) =
        sign / (kHeadTranslation * distance) * Eigen::Matrix3d::Identity();
  };
  fill(i, first, 1);
  fill(j, second, -1);
  window.prior.sqrt_information = TriangularFactor(rows).topRows(width);
}

}  // namespace

void AddCameras(const Rig& rig, const CalibrationOptions& options, SmootherWindow& window) {
  window.camera_noise_scales.assign(rig.cameras.size(), 1.0);
  for (size_t i = 0; i < rig.cameras.size(); ++i) {
    const RigCamera& camera = rig.cameras[i];
    CameraParameters& parameters = window.cameras.emplace_back();
    PoseToParameters(rig.ImuFromCamera(i), parameters.extrinsics.data());
    parameters.timing = {0, camera.line_delay};
    CameraSettings& settings = window.camera_settings.emplace_back();
    settings.middle_row = 0.5 * (camera.model.height() - 1);
    settings.has_extrinsics = options.extrinsics;
    settings.has_time_offset = options.time_offset;
    settings.has_line_delay = options.line_delay && camera.line_delay != 0;
    const double translation = std::clamp(options.translation_share * ArmOf(rig, i),
                                          kMinTranslationSigma, options.translation);
    const double head_share = std::min(1.0, rig.ImuFromCamera(i).translation.norm() / kHeadSize);
    settings.prior = {std::max(kHeadRotation, head_share * options.rotation_deg * M_PI / 180),
                      translation, options.time_offset_sigma,
                      options.line_delay_share * std::abs(camera.line_delay)};
  }
}

void AddPriorOfCameras(SmootherWindow& window) {
  for (size_t i = 0; i < window.cameras.size(); ++i) {
    const CameraSettings& settings = window.camera_settings[i];
    const auto add = [&](const StateName& name, const Eigen::VectorXd& sigmas) {
      if (!window.IsEstimated(name)) return;
      window.prior.blocks.push_back({name, {}});
      std::copy_n(window.ValuesOf(name), name.Size(), window.prior.blocks.back().at.begin());
      const Eigen::Index column = window.prior.sqrt_information.cols(),
                         width = column + sigmas.size();
      window.prior.sqrt_information.conservativeResizeLike(Eigen::MatrixXd::Zero(width, width));
      window.prior.sqrt_information.diagonal().tail(sigmas.size()) = sigmas.cwiseInverse();
      window.prior.offset.conservativeResizeLike(Eigen::VectorXd::Zero(width));
    };
    const auto camera = static_cast<std::int64_t>(i);
    Eigen::VectorXd extrinsics(kPoseTangentSize);
    extrinsics << Eigen::Vector3d::Constant(settings.prior.rotation),
        Eigen::Vector3d::Constant(settings.prior.translation);
    add({Kind::kExtrinsics, camera}, extrinsics);
    add({Kind::kTiming, camera},
        Eigen::Vector2d(settings.has_time_offset ? settings.prior.time_offset : kHeld,
                        settings.has_line_delay ? settings.prior.line_delay : kHeld));
  }
  for (size_t i = 0; i < window.cameras.size(); ++i)
    for (size_t j = i + 1; j < window.cameras.size(); ++j) AddPriorOfPair(i, j, window);
}

void UpdateCameraNoise(SmootherWindow& window) {
  std::vector<std::vector<double>> squared_errors(window.camera_noise_scales.size());
  std::vector<double> share(window.camera_noise_scales.size(),
                            0);  // of the errors that landmarks absorbed
  for (const auto& [number, track] : window.tracks) {
    if (!track.has_landmark) continue;
    for (const TrackObservation& seen : track.observations) {
      const auto camera = static_cast<size_t>(seen.view->camera);
      const Eigen::Vector3d direction =
          LandmarkInCamera(seen.view->geometry, track.ray, track.landmark.data(), seen.bearing.row);
      const double scaled = 1 / (seen.bearing.sigma / window.camera_noise_scales[camera]);
      squared_errors[camera].push_back(
          (scaled * seen.bearing.basis.transpose() * direction.normalized()).squaredNorm());
      share[camera] += 1.5 / static_cast<double>(track.observations.size());
    }
  }
  for (size_t camera = 0; camera < squared_errors.size(); ++camera) {
    std::vector<double>& errors = squared_errors[camera];
    if (errors.size() < kMinErrorsForNoise) continue;
    std::nth_element(errors.begin(), errors.begin() + static_cast<long>(errors.size() / 2),
                     errors.end());
    const double freedom = std::max(0.2, 1 - share[camera] / static_cast<double>(errors.size()));
    const double variance = errors[errors.size() / 2] / kMedianOfChiSquared2 / freedom;
    double& scale = window.camera_noise_scales[camera];
    scale = std::clamp(std::sqrt((1 - kNoiseGain) * scale * scale + kNoiseGain * variance),
                       kMinNoiseScale, kMaxNoiseScale);
  }
}

}  // namespace parkade
