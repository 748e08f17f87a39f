#include "tests/bench/odometry/odometry_places.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "slam/evaluation/evaluate_trajectory.h"
#include "slam/refinement/refine_drive.h"
#include "tests/bench/odometry/odometry_statistics.h"

namespace parkade {
namespace {

using simulator::TrackDrive;

constexpr size_t kErrorStride = 10;  // poses of the truth

/// Errors of one estimate, after rigid alignment.
struct EstimateErrors {
  double drift = kNoAnswer, scale = 0;  // [%]
  std::vector<std::optional<Eigen::Vector3d>>
      position_errors;  // [m] at every kErrorStride-th pose of the truth
};

EstimateErrors ErrorsOf(const TrackDrive& drive, const Trajectory& odom_from_body) {
  const TrajectoryEvaluation evaluation =
      EvaluateTrajectory(drive.truth, ToTimedPoses(odom_from_body));
  EstimateErrors errors;
  errors.drift =
      std::min(kNoAnswer, 100 * evaluation.rigid.translation.rmse / std::max(1.0, drive.length));
  errors.scale = 100 * (evaluation.scale - 1);
  for (size_t i = 0; i < drive.truth.size(); i += kErrorStride) {
    const std::optional<Rigid3> at = odom_from_body.At(drive.truth[i].time);
    std::optional<Eigen::Vector3d>& error = errors.position_errors.emplace_back();
    if (at)
      error = evaluation.rigid.truth_from_estimate * at->translation -
              drive.truth[i].world_from_frame.translation;
  }
  return errors;
}

/// Figures of the odometry and, where asked for, of the whole drive's adjustment.
std::vector<EstimateErrors> Estimate(const TrackDrive& drive, const PlaceEstimators& estimators) {
  std::vector<EstimateErrors> errors(estimators.whole_drive ? 2 : 1);
  try {
    const OdometryResult odometry = EstimateTrackDrive(drive, estimators.odometry);
    errors[0] = ErrorsOf(drive, odometry.odom_from_body);
    if (!estimators.whole_drive) return errors;
    LoopClosure open;
    open.odom_from_body = odometry.odom_from_body;
    const DriveRefinement refined = RefineDrive(odometry, drive.rig, open, *estimators.whole_drive);
    if (refined.is_accepted) errors[1] = ErrorsOf(drive, refined.odom_from_body);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::kUsage) throw;
  }
  return errors;
}

std::vector<double> ErrorProducts(const std::vector<EstimateErrors>& estimates, double length) {
  const size_t n = estimates.size();
  for (const EstimateErrors& estimate : estimates)
    if (estimate.position_errors.empty()) return {};
  Eigen::MatrixXd sum =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
  double count = 0;
  for (size_t i = 0; i < estimates.front().position_errors.size(); ++i) {
    Eigen::Matrix3Xd errors(3, n);
    bool is_known = true;
    for (size_t j = 0; j < n; ++j) {
      const std::optional<Eigen::Vector3d>& error = estimates[j].position_errors[i];
      is_known = is_known && error;
      if (error) errors.col(static_cast<Eigen::Index>(j)) = *error;
    }
    if (!is_known) continue;
    sum += errors.transpose() * errors;
    ++count;
  }
  if (count == 0) return {};
  const double to_percent = 100 / std::max(1.0, length);
  sum *= to_percent * to_percent / count;
  return {sum.data(), sum.data() + sum.size()};
}

}  // namespace

PlaceCase ParsePlace(const std::string& name, double duration) {
  const size_t first = name.find(':'), second = name.find(':', first + 1);
  const std::string seed =
      first == std::string::npos ? "" : name.substr(first + 1, second - first - 1);
  Require(
      !seed.empty() && seed.size() < 9 && seed.find_first_not_of("0123456789") == std::string::npos,
      ErrorCode::kUsage, "'" + name + "' is no place: SCENE:SEED[:START]");
  PlaceCase place;
  place.name = name;
  if (second != std::string::npos) place.start = name.substr(second + 1);
  Require(place.start == "standing" || place.start == "rolling" || place.start == "turning",
          ErrorCode::kUsage, "'" + name + "' must start standing, rolling or turning");
  simulator::SimulateOptions& drive = place.drive.drive;
  drive.scene = name.substr(0, first);
  drive.seed = std::stoi(seed);
  drive.duration = duration;
  drive.sensors.has_wheels = false;
  drive.sensors.gnss = "none";
  return place;
}

void SetRigError(const std::string& rig, simulator::TrackDriveOptions& drive) {
  if (rig == "exact") return;
  Require(rig == "0.3" || rig == "1", ErrorCode::kUsage,
          "'" + rig + "' is no rig: exact, 0.3 or 1");
  drive.drive.faults.extrinsic_rotation_deg = {std::stod(rig)};
  drive.drive.faults.extrinsic_translation_cm = {rig == "1" ? 3.0 : 1.0};
}

TrackDrive OneCamera(const TrackDrive& drive, size_t camera) {
  TrackDrive one = drive;
  one.rig.cameras = {drive.rig.cameras.at(camera)};
  one.true_rig.cameras = {drive.true_rig.cameras.at(camera)};
  std::erase_if(one.images, [&](const simulator::SeenImage& image) {
    return image.frame.camera != static_cast<int>(camera);
  });
  for (simulator::SeenImage& image : one.images) {
    image.frame.camera = 0;
    image.crossed.clear();
    image.pair_seconds = 0;
  }
  return one;
}

RefinementOptions WholeDriveOptions() {
  constexpr int kAll = 100000;
  constexpr double kWhatever = 1e9;
  RefinementOptions options;
  options.bearings_per_image = options.observations_per_track = kAll;
  options.min_observations = options.min_nodes = 3;
  options.held_out_share = 0;
  options.max_imu_growth = options.max_held_out_growth = options.max_track_growth = kWhatever;
  return options;
}

std::vector<PlaceRun> RunPlace(const PlaceCase& place, const std::string& rig, int noise_seed,
                               const PlaceEstimators& estimators) {
  simulator::TrackDriveOptions asked = place.drive;
  SetRigError(rig, asked);
  asked.noise_seed = noise_seed;
  if (place.start != "standing")
    asked.begin = simulator::FindMovingStart(asked, place.start == "turning");
  const TrackDrive drive = simulator::MakeTrackDrive(asked, estimators.odometry);
  std::vector<std::vector<EstimateErrors>> errors{Estimate(drive, estimators)};
  for (size_t camera = 0; camera < drive.rig.cameras.size(); ++camera)
    errors.push_back(Estimate(OneCamera(drive, camera), estimators));
  std::vector<PlaceRun> runs;
  for (size_t i = 0; i < errors.front().size(); ++i) {
    PlaceRun& run = runs.emplace_back();
    run.place = place.name;
    run.rig = rig;
    run.estimator = i == 0 ? PlaceRun::kOdometry : PlaceRun::kWholeDrive;
    run.noise_seed = noise_seed;
    run.length = drive.length;
    std::vector<EstimateErrors> of_this;
    for (const std::vector<EstimateErrors>& of_cameras : errors) of_this.push_back(of_cameras[i]);
    for (const EstimateErrors& of_cameras : of_this) {
      run.drift_percent.push_back(of_cameras.drift);
      run.scale_percent.push_back(of_cameras.scale);
    }
    run.error_products = ErrorProducts(of_this, drive.length);
  }
  return runs;
}

nlohmann::json ToJson(const PlaceRun& run) {
  return {{"place", run.place},
          {"rig", run.rig},
          {"estimator", run.estimator},
          {"noise_seed", run.noise_seed},
          {"length_m", run.length},
          {"drift_percent", run.drift_percent},
          {"scale_percent", run.scale_percent},
          {"error_products", run.error_products}};
}

PlaceRun PlaceRunFromJson(const nlohmann::json& json) {
  PlaceRun run;
  json.at("place").get_to(run.place);
  json.at("rig").get_to(run.rig);
  json.at("estimator").get_to(run.estimator);
  json.at("noise_seed").get_to(run.noise_seed);
  json.at("length_m").get_to(run.length);
  json.at("drift_percent").get_to(run.drift_percent);
  json.at("scale_percent").get_to(run.scale_percent);
  json.at("error_products").get_to(run.error_products);
  return run;
}

}  // namespace parkade
